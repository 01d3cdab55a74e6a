import { wordOf } from "../parameters/choice_word.js";
import { COMMANDS } from "./edits.js";

/**
 * Every field that may change while the scenario runs, of the kinds that would then be in force.
 *
 * @param {object[]} panels of layout.js @param {import("./parameter_schema.js").ParameterSchema} schema
 * @param {(path: string) => any} read a value of the document as it would then be
 * @returns {{path: string, label: string, unit: string, options: {value: any, text: string}[]|null}[]}
 */
export function changeableFields(panels, schema, read) {
  return panels.filter(({ part }) => part?.split(".")[0] in COMMANDS).flatMap((panel) => fieldsOf(panel, schema, read));
}

function fieldsOf({ title, part, kinds }, schema, read) {
  const now = kinds ? read(`${part}.kind`) : undefined;
  const plain = schema
    .names(part, now)
    .map((name) => schema.field(part, name, now))
    .filter((field) => field && !field.isList);
  const fields = plain.map((field) => ({
    path: `${part}.${field.name}`,
    label: `${title}: ${field.title}${field.symbol ? ` ${field.symbol.replace("_", "")}` : ""}`,
    unit: field.unit,
    options: field.choices?.map((value) => ({ value, text: wordOf(value) })) ?? null,
  }));
  if (!kinds || kinds.length < 2) return fields;
  const options = kinds.map(({ kind, label }) => ({ value: kind, text: label }));
  return [{ path: `${part}.kind`, label: `${title}: kind`, unit: "", options }, ...fields];
}
