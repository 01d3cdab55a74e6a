import { COMMANDS } from "../document/edits.js";

/**
 * Where the value of a row lives that shows one field of a part: see ParameterRow.
 *
 * With a `kind`, there is a value only while the part is of that kind. With `beside`, the value is a pair with that field's.
 * What cannot change live restarts the scenario.
 */
export function placeIn({ document, edits, baseline }, part, name, kind, beside) {
  const [section, ...inner] = part.split(".");
  const isLive = section in COMMANDS;
  const inPart = (field) => [part, field].filter(Boolean).join(".");
  const relative = (field) => [...inner, field].join(".");
  const both = (read) => (beside ? [read(inPart(name)), read(inPart(beside))] : read(inPart(name)));
  const isOther = (read) => Boolean(kind) && read(`${part}.kind`) !== kind;
  return {
    path: inPart(name),
    restarts: !isLive,
    read: () => (isOther((path) => document.value(path)) ? undefined : both((path) => document.value(path))),
    baseline: () => (isOther((path) => baseline.value(path)) ? undefined : both((path) => baseline.value(path))),
    write: (value) => {
      if (!isLive) return edits.restart({ [inPart(name)]: value });
      const changes = beside
        ? { [relative(name)]: value[0], [relative(beside)]: value[1] }
        : { [relative(name)]: value };
      return edits.change(section, changes);
    },
  };
}
