import { PANELS } from "../layout.js";
import { wordOf } from "../parameters/choice_word.js";

const WITHOUT = new Set(["name", "description"]);
const TITLES = new Map(PANELS.flatMap((panel) => panel.groups ?? [panel]).map(({ part, title }) => [part, title]));
const BEING_OF = new Map(PANELS.flatMap(({ part, kinds }) => (kinds ?? []).map(({ kind, label }) => [`${part} ${kind}`, label])));

/**
 * Every field of a scenario that a batch can vary: where it is, what it is called, its unit and range as the schema says,
 * what the scenario has there. One with `options` takes only these.
 *
 * @param {object} scenario document @param {import("../document/parameter_schema.js").ParameterSchema} schema
 * @returns {{path: string, label: string, title: string, symbol: string, unit: string, low: number, high: number,
 *   typical: [number, number], isLogarithmic: boolean, isWhole: boolean, value: any,
 *   options: {value: any, text: string}[]|null}[]}
 */
export function scenarioFields(scenario, schema) {
  return [...fieldsOf(scenario, "", schema)];
}

/** @returns {string} a name for a path that no present field has */
export function pathWords(path) {
  return path.split(".").slice(-2).join(" ").replaceAll("_", " ");
}

function* fieldsOf(part, path, schema) {
  for (const [name, value] of Object.entries(part)) {
    const inner = path ? `${path}.${name}` : name;
    if (Array.isArray(value)) {
      for (const [place, item] of value.entries()) if (isPart(item)) yield* fieldsOf(item, `${inner}.${place}`, schema);
    } else if (isPart(value)) yield* fieldsOf(value, inner, schema);
    else if (!WITHOUT.has(inner)) {
      const found = name === "kind" ? kindField(inner, path, value, schema) : plainField(inner, path, name, value, part.kind, schema);
      if (found) yield found;
    }
  }
}

function plainField(path, part, name, value, kind, schema) {
  const field = schema.field(listOf(part), name, kind);
  if (!field || field.isList || (typeof value === "string" && !field.choices)) return null;
  return {
    ...field,
    path,
    value,
    label: [titleOf(part), field.title].filter(Boolean).join(": "),
    options: field.choices?.map((choice) => ({ value: choice, text: wordOf(choice) })) ?? null,
  };
}

function kindField(path, part, value, schema) {
  if (part.match(/\.\d+$/)) return null; // another term of a list has other fields
  const kinds = schema.kinds(part);
  if (kinds.length < 2) return null;
  const options = kinds.map((kind) => ({ value: kind, text: BEING_OF.get(`${part} ${kind}`) ?? wordOf(kind) }));
  return { path, value, title: titleOf(part).toLowerCase(), label: `${titleOf(part)}: kind`, symbol: "", unit: "", options };
}

/** The path of a list's item without its number: the schema has one shape for all of them. */
function listOf(part) {
  return part.replace(/\.\d+$/, "");
}

function titleOf(part) {
  const [, list, place] = part.match(/^(.*)\.(\d+)$/) ?? [];
  if (list) return `${list.startsWith("disturbances.") ? "Disturbance on " : ""}${pathWords(list).replace("disturbances ", "")} ${Number(place) + 1}`;
  return part === "" ? "Scenario" : (TITLES.get(part) ?? pathWords(part));
}

function isPart(value) {
  return value !== null && typeof value === "object" && !Array.isArray(value);
}
