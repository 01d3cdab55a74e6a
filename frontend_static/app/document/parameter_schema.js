/** Where a default comes from, in words (the schema has the letter). */
const BASIS = { D: "datasheet", P: "the paper", E: "engineering estimate", C: "our choice" };

/**
 * What the server's JSON schema says of each parameter: title, symbol, unit, ranges, step, scale, meaning, equation.
 */
export class ParameterSchema {
  /** @param {object} scenario JSON schema of the Scenario document */
  constructor(scenario) {
    this.root = scenario;
  }

  /** @param {string} part path of a part, such as "tuning.controller" @param {string} [kind] which of its kinds
   *  @returns {object|null} schema of that part */
  part(part, kind) {
    let schema = this.root;
    for (const name of part.split(".")) schema = this.#resolve(schema?.properties?.[name]);
    if (schema?.type === "array") schema = schema.items;
    if (kind === undefined || !schema) return schema ?? null;
    const alternatives = (schema.oneOf ?? schema.anyOf ?? [schema]).map((option) => this.#resolve(option));
    return alternatives.find((option) => option?.properties?.kind?.const === kind) ?? null;
  }

  /** @returns {Field|null} one parameter of a part (of a kind) */
  field(part, name, kind) {
    const schema = this.#resolve(this.part(part, kind)?.properties?.[name]);
    return schema ? new Field(name, schema) : null;
  }

  /** @returns {string[]} names of the parameters of a part, in the document's order */
  names(part, kind) {
    return Object.keys(this.part(part, kind)?.properties ?? {}).filter((name) => name !== "kind");
  }

  #resolve(schema) {
    if (!schema?.$ref) return schema;
    const { $ref, ...own } = schema;
    return { ...this.root.$defs[$ref.split("/").pop()], ...own };
  }
}

export class Field {
  constructor(name, schema) {
    this.title = schema.title || name.replaceAll("_", " ");
    this.symbol = schema.symbol || "";
    this.unit = schema.unit || "";
    this.description = schema.description || "";
    this.equation = schema.equation || "";
    this.basis = BASIS[schema.basis] ?? "";
    this.default = schema.default;
    this.low = schema.minimum ?? schema.exclusiveMinimum ?? -Infinity;
    this.high = schema.maximum ?? schema.exclusiveMaximum ?? Infinity;
    this.typical = schema.typical ?? [this.low, this.high];
    this.isLogarithmic = schema.scale === "log" && this.typical[0] > 0;
    this.step = schema.step ?? (this.typical[1] - this.typical[0]) / 100;
    this.isWhole = schema.type === "integer";
    this.choices = schema.type === "boolean" ? [true, false] : (schema.enum ?? null);
  }
}
