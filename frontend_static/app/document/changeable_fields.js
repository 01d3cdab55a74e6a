import { wordOf } from "../parameters/choice_word.js";
import { COMMANDS } from "./edits.js";

/**
 * Every field that may change while the scenario runs, of the kinds that would then be in force.
 *
 * @param {object[]} panels of layout.js @param {import("./parameter_schema.js").ParameterSchema} schema
 * @param {(path: string) => any} read a value of the document as it would then be
 * @returns {{path: string, label: string, unit: string, low: number, high: number,
 *   isNullable: boolean, options: {value: any, text: string}[]|null}[]}
 */
export function changeableFields(panels, schema, read) {
  return panels.filter(({ part }) => part?.split(".")[0] in COMMANDS).flatMap((panel) => fieldsOf(panel, schema, read));
}

/** @returns {object[]} the fields that a text may mean: one if it is a whole name, or enough of one */
export function fieldsNamed(text, fields) {
  const wanted = text.trim().toLowerCase();
  const words = wanted.split(/[\s:]+/);
  const named = (fits) => fields.filter((field) => fits(field.label.toLowerCase(), field.path));
  const tries = [
    (label, path) => label === wanted || path === wanted,
    (label) => label.endsWith(wanted),
    (label) => words.every((word) => label.includes(word)),
  ];
  const found = tries.map(named).filter((each) => each.length);
  return wanted ? (found.find((each) => each.length === 1) ?? found[0] ?? []) : [];
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
    low: field.low,
    high: field.high,
    isNullable: field.isNullable,
    options: field.choices?.map((value) => ({ value, text: wordOf(value) })) ?? null,
  }));
  if (!kinds || kinds.length < 2) return fields;
  const options = kinds.map(({ kind, label }) => ({ value: kind, text: label }));
  return [{ path: `${part}.kind`, label: `${title}: kind`, unit: "", options }, ...fields];
}
