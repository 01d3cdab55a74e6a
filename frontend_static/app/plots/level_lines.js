/**
 * Two fixed limits of a chart's left scale, as dashed lines: drawn, and given room, when the signal is near them.
 * `levels` is {low, high, near, words}, in SI; nothing where a layout has none.
 */
export class LevelLines {
  #isNear = false;

  constructor(levels) {
    this.levels = levels;
  }

  /** @returns {[number, number]} the span that the scale must show for a signal between `low` and `high` */
  withRoom(low, high) {
    const { levels } = this;
    if (!levels) return [low, high];
    const middle = (levels.low + levels.high) / 2;
    const half = (levels.high - levels.low) / 2;
    this.#isNear = Math.max(high - middle, middle - low) > levels.near * half || levels.near === 0;
    if (!this.#isNear) return [low, high];
    if (levels.near === 0) return [Math.min(low, levels.low), Math.max(high, levels.high)];
    const nearHigh = high - middle > levels.near * half;
    const nearLow = middle - low > levels.near * half;
    return [nearLow ? Math.min(low, levels.low) : low, nearHigh ? Math.max(high, levels.high) : high];
  }

  draw({ ctx, bbox, valToPos, scales }, palette) {
    if (!this.levels || !this.#isNear) return;
    ctx.save();
    ctx.strokeStyle = palette.colour("limit-line");
    ctx.lineWidth = devicePixelRatio;
    ctx.setLineDash([2 * devicePixelRatio, 3 * devicePixelRatio]);
    ctx.beginPath();
    for (const value of [this.levels.low, this.levels.high]) {
      if (value < scales.left.min || value > scales.left.max) continue;
      const y = Math.round(valToPos(value, "left", true)) + 0.5;
      ctx.moveTo(bbox.left, y);
      ctx.lineTo(bbox.left + bbox.width, y);
    }
    ctx.stroke();
    ctx.restore();
  }
}
