/**
 * Border between two regions of a grid, by marching squares.
 *
 * @param {number[][]} field rows of numbers; the border is where they pass through zero
 * @returns {[number, number, number, number][]} segments x0, y0, x1, y1 in cells: 0 is the centre of the first
 */
export function zeroContour(field) {
  const segments = [];
  for (let j = 0; j + 1 < field.length; j += 1)
    for (let i = 0; i + 1 < field[j].length; i += 1) {
      const corners = [field[j][i], field[j][i + 1], field[j + 1][i + 1], field[j + 1][i]];
      const points = [];
      const places = [
        [i, j],
        [i + 1, j],
        [i + 1, j + 1],
        [i, j + 1],
      ];
      for (let edge = 0; edge < 4; edge += 1) {
        const [a, b] = [corners[edge], corners[(edge + 1) % 4]];
        if (a > 0 === b > 0) continue;
        const share = a / (a - b);
        const [[x0, y0], [x1, y1]] = [places[edge], places[(edge + 1) % 4]];
        points.push([x0 + share * (x1 - x0), y0 + share * (y1 - y0)]);
      }
      for (let n = 0; n + 1 < points.length; n += 2) segments.push([...points[n], ...points[n + 1]]);
    }
  return segments;
}
