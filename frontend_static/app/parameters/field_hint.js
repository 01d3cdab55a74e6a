import { element } from "../element.js";
import { inputText } from "../quantity.js";
import { wordOf } from "./choice_word.js";
import { symbol } from "./symbol.js";

const DELAY_MS = 350;

/** The one floating text that explains a parameter: meaning, equation, range, default and where it comes from. */
export class FieldHint {
  #timer = null;

  constructor() {
    this.box = element("div", { id: "field-hint", role: "tooltip", hidden: true });
    document.body.append(this.box);
    addEventListener("scroll", () => this.hide(), { capture: true, passive: true });
  }

  /** Show the hint of a row while the pointer rests on it or its name has focus. */
  attach(row, describe) {
    const show = () => {
      clearTimeout(this.#timer);
      this.#timer = setTimeout(() => this.#show(row, describe()), DELAY_MS);
    };
    row.addEventListener("pointerenter", show);
    row.addEventListener("focusin", show);
    row.addEventListener("pointerleave", () => this.hide());
    row.addEventListener("focusout", () => this.hide());
    row.addEventListener("pointerdown", () => this.hide());
    row.addEventListener("keydown", () => this.hide());
  }

  hide() {
    clearTimeout(this.#timer);
    this.box.hidden = true;
  }

  #show(row, lines) {
    if (!row.isConnected) return;
    this.box.replaceChildren(...lines.filter((line) => line.text).map(paragraph));
    this.box.hidden = false;
    const place = row.getBoundingClientRect();
    const { offsetWidth, offsetHeight } = this.box;
    const fitsRight = place.right + 8 + offsetWidth < innerWidth;
    this.box.style.left = `${fitsRight ? place.right + 8 : Math.max(8, innerWidth - offsetWidth - 8)}px`;
    const top = fitsRight ? place.top - 4 : place.bottom + 4;
    this.box.style.top = `${Math.max(8, Math.min(top, innerHeight - offsetHeight - 8))}px`;
  }
}

function paragraph(line) {
  return element("p", { class: line.class ?? null }, line.text, ...(line.symbol ? ["  ", ...symbol(line.symbol)] : []));
}

/** @returns {{text: string, symbol?: string, class?: string}[]} what the hint says of a field */
export function describeField(field, baselineText) {
  const unit = field.unit ? ` ${field.unit}` : "";
  const source = field.basis ? `, ${field.basis}` : "";
  const range =
    Number.isFinite(field.low) && Number.isFinite(field.high)
      ? `Permitted ${inputText(field.low)} to ${inputText(field.high)}${unit}`
      : "";
  const normal = field.isNullable && field.default === null ? "none" : defaultWords(field, unit);
  return [
    { text: field.title, symbol: field.symbol, class: "hint-title" },
    { text: field.description },
    { text: field.equation ? `Eq. ${field.equation}` : "", class: "hint-dim" },
    { text: range, class: "hint-dim" },
    { text: normal ? `Default ${normal}${source}` : "", class: "hint-dim" },
    { text: baselineText, class: "hint-changed" },
  ];
}

function defaultWords(field, unit) {
  if (field.isList) return "";
  return typeof field.default === "number" ? inputText(field.default) + unit : wordOf(field.default ?? "");
}
