import { element } from "../element.js";
import { fitted } from "../plots/fitted_canvas.js";
import { niceTicks } from "../plots/nice_ticks.js";
import { sequential, sequentialColour } from "./colour_scale.js";
import { zeroContour } from "./contour.js";
import { logTicks, tickText } from "./log_ticks.js";

const PAD = { left: 62, right: 96, top: 14, bottom: 46 };
const BAR_PX = 14;
const FONT = 'system-ui, -apple-system, "Segoe UI", sans-serif';
const FAR = 1e3; // 1/s: stands for a growth that is not finite

/** A map on a canvas: stable cells in a sequential scale, unstable ones grey, the border between them, the present loop. */
export class MapCanvas {
  /** @param {(cell: {i: number, j: number}|null, event: PointerEvent|null) => void} pointed */
  constructor(palette, pointed) {
    this.palette = palette;
    this.canvas = element("canvas", { class: "map-canvas", tabindex: "0", role: "img", "aria-label": "No map yet" });
    this.canvas.addEventListener("pointermove", (event) => pointed(this.#cellAt(event), event));
    this.canvas.addEventListener("pointerleave", () => pointed(null, null));
    this.root = element("div", { class: "map-area" }, this.canvas);
    this.picture = null;
    new ResizeObserver(() => this.draw()).observe(this.root);
  }

  /** @param {object|null} picture {x, y: {axis: Axis, values}, values, stable, growth?, range, unit, legend, thin?, marks: [{x, y, kind}]} */
  show(picture) {
    this.picture = picture;
    this.draw();
  }

  draw() {
    const room = fitted(this.canvas, this.root);
    if (!room) return;
    const { ctx, width, height } = room;
    this.box = {
      left: PAD.left,
      top: PAD.top,
      width: Math.max(10, width - PAD.left - PAD.right),
      height: Math.max(10, height - PAD.top - PAD.bottom),
    };
    if (!this.picture) return;
    this.#cells(ctx);
    this.#borders(ctx);
    this.#marks(ctx);
    this.#axes(ctx);
    this.#legend(ctx, width);
  }

  #cells(ctx) {
    const { values, stable, range } = this.picture;
    const [rows, columns] = [values.length, values[0].length];
    const image = new ImageData(columns, rows);
    const grey = rgbOf(this.palette.colour("track"));
    for (let j = 0; j < rows; j += 1)
      for (let i = 0; i < columns; i += 1) {
        const value = values[j][i] ?? Infinity;
        const colour = stable[j][i] ? sequential((value - range[0]) / (range[1] - range[0])) : grey;
        image.data.set([...colour, 255], 4 * ((rows - 1 - j) * columns + i));
      }
    const small = element("canvas", { width: columns, height: rows });
    small.getContext("2d").putImageData(image, 0, 0);
    ctx.imageSmoothingEnabled = false;
    ctx.drawImage(small, this.box.left, this.box.top, this.box.width, this.box.height);
  }

  #borders(ctx) {
    const { values, stable, growth, thin } = this.picture;
    const field = growth
      ? growth.map((row) => row.map((value) => -(value ?? FAR)))
      : stable.map((row) => row.map((each) => (each ? 1 : -1)));
    ctx.strokeStyle = this.palette.colour("text");
    ctx.lineWidth = 1.75;
    this.#segments(ctx, zeroContour(field));
    if (thin === undefined) return;
    ctx.lineWidth = 1;
    ctx.setLineDash([4, 3]);
    ctx.strokeStyle = "#fff";
    const above = values.map((row, j) => row.map((value, i) => (stable[j][i] ? (value ?? FAR) - thin : -thin)));
    this.#segments(ctx, zeroContour(above));
    ctx.setLineDash([]);
  }

  #segments(ctx, segments) {
    ctx.beginPath();
    for (const [x0, y0, x1, y1] of segments) {
      ctx.moveTo(...this.#place(x0, y0));
      ctx.lineTo(...this.#place(x1, y1));
    }
    ctx.stroke();
  }

  #marks(ctx) {
    for (const { x, y, kind } of this.picture.marks) {
      const [i, j] = [indexOf(this.picture.x, x), indexOf(this.picture.y, y)];
      const { values } = this.picture;
      if (!(i >= -0.5 && i <= values[0].length - 0.5 && j >= -0.5 && j <= values.length - 0.5)) continue;
      const [px, py] = this.#place(i, j);
      for (const [colour, width] of [
        ["#fff", 4],
        ["#111", 1.75],
      ]) {
        ctx.strokeStyle = colour;
        ctx.lineWidth = width;
        ctx.beginPath();
        if (kind === "present") {
          ctx.arc(px, py, 6, 0, 2 * Math.PI);
          for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
            ctx.moveTo(px + 3 * dx, py + 3 * dy);
            ctx.lineTo(px + 10 * dx, py + 10 * dy);
          }
        } else {
          ctx.moveTo(px, py - 7);
          for (const [dx, dy] of [[7, 0], [0, 7], [-7, 0], [0, -7]]) ctx.lineTo(px + dx, py + dy);
        }
        ctx.stroke();
      }
    }
  }

  #axes(ctx) {
    const { left, top, width, height } = this.box;
    ctx.strokeStyle = this.palette.colour("control-line");
    ctx.lineWidth = 1;
    ctx.strokeRect(left - 0.5, top - 0.5, width + 1, height + 1);
    ctx.fillStyle = this.palette.colour("axis-text");
    ctx.font = `11px ${FONT}`;
    ctx.textAlign = "center";
    ctx.textBaseline = "top";
    for (const { index, text } of ticksOf(this.picture.x, 8)) {
      const [x] = this.#place(index, 0);
      line(ctx, x, top + height, x, top + height + 4);
      ctx.fillText(text, x, top + height + 7);
    }
    ctx.textAlign = "right";
    ctx.textBaseline = "middle";
    for (const { index, text } of ticksOf(this.picture.y, 7)) {
      const [, y] = this.#place(0, index);
      line(ctx, left - 4, y, left, y);
      ctx.fillText(text, left - 7, y);
    }
    ctx.fillStyle = this.palette.colour("text");
    ctx.font = `12px ${FONT}`;
    ctx.textAlign = "center";
    ctx.fillText(this.picture.x.axis.title, left + width / 2, top + height + 33);
    ctx.save();
    ctx.translate(13, top + height / 2);
    ctx.rotate(-Math.PI / 2);
    ctx.fillText(this.picture.y.axis.title, 0, 0);
    ctx.restore();
  }

  #legend(ctx, width) {
    const { range, unit, legend } = this.picture;
    const { top, height } = this.box;
    const left = width - PAD.right + 18;
    const grey = 16;
    const tall = height - grey - 8;
    for (let y = 0; y < tall; y += 1) {
      ctx.fillStyle = sequentialColour(1 - y / tall);
      ctx.fillRect(left, top + y, BAR_PX, 1.5);
    }
    ctx.fillStyle = this.palette.colour("track");
    ctx.fillRect(left, top + tall + 8, BAR_PX, grey);
    ctx.fillStyle = this.palette.colour("axis-text");
    ctx.font = `11px ${FONT}`;
    ctx.textAlign = "left";
    ctx.textBaseline = "middle";
    for (const tick of niceTicks(...range, 5)) {
      const y = top + tall * (1 - (tick - range[0]) / (range[1] - range[0]));
      ctx.fillText(`${tickText(tick)}${unit === "°" ? "°" : ""}`, left + BAR_PX + 5, y);
    }
    ctx.fillText("unstable", left + BAR_PX + 5, top + tall + 8 + grey / 2);
    ctx.save();
    ctx.translate(left - 8, top + tall / 2);
    ctx.rotate(-Math.PI / 2);
    ctx.textAlign = "center";
    ctx.fillText(unit && unit !== "°" ? `${legend} [${unit}]` : legend, 0, 0);
    ctx.restore();
  }

  /** Pixel of a place in cells; the centre of the first cell is 0. */
  #place(i, j) {
    const { left, top, width, height } = this.box;
    const { values } = this.picture;
    return [left + ((i + 0.5) / values[0].length) * width, top + height - ((j + 0.5) / values.length) * height];
  }

  #cellAt(event) {
    if (!this.picture || !this.box) return null;
    const area = this.canvas.getBoundingClientRect();
    const { left, top, width, height } = this.box;
    const { values } = this.picture;
    const i = Math.floor(((event.clientX - area.left - left) / width) * values[0].length);
    const j = Math.floor((1 - (event.clientY - area.top - top) / height) * values.length);
    return i >= 0 && j >= 0 && i < values[0].length && j < values.length ? { i, j } : null;
  }
}

/** Where a value lies between the cells of a side: 0 is the first, on the axis's own scale. */
function indexOf({ axis, values }, value) {
  if (value === null || value === undefined) return NaN;
  const [first, last] = [values[0], values.at(-1)];
  const share = axis.isLogarithmic ? Math.log(value / first) / Math.log(last / first) : (value - first) / (last - first);
  return share * (values.length - 1);
}

function ticksOf(side, count) {
  const { axis, values } = side;
  const [low, high] = [values[0] * axis.factor, values.at(-1) * axis.factor];
  const ticks = axis.isLogarithmic ? logTicks(low, high) : niceTicks(low, high, count);
  return ticks.map((tick) => ({ index: indexOf(side, tick / axis.factor), text: tickText(tick) }));
}

function rgbOf(colour) {
  return colour.match(/[\d.]+/g).slice(0, 3).map(Number);
}

function line(ctx, x0, y0, x1, y1) {
  ctx.beginPath();
  ctx.moveTo(x0, y0);
  ctx.lineTo(x1, y1);
  ctx.stroke();
}
