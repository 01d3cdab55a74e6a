/** @returns {{at_s: number, path: string, value: any}[]} a sequence of the document, one field a line */
export function linesOf(sequence) {
  return sequence.flatMap(({ at_s, changes }) =>
    Object.entries(changes).map(([path, value]) => ({ at_s, path, value })),
  );
}

/** @returns {{at_s: number, changes: object}[]} lines as the document has them: in order, those of one time together */
export function entriesOf(lines) {
  const entries = [];
  for (const { at_s, path, value } of [...lines].sort((a, b) => a.at_s - b.at_s)) {
    const last = entries.at(-1);
    if (last?.at_s === at_s && !(path in last.changes)) last.changes[path] = value;
    else entries.push({ at_s, changes: { [path]: value } });
  }
  return entries;
}
