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
    for (const name of part === "" ? [] : part.split(".")) schema = this.#resolve(schema?.properties?.[name]);
    if (schema?.type === "array") schema = this.#resolve(schema.items);
    if (kind === undefined || !schema) return schema ?? null;
    const alternatives = (schema.oneOf ?? schema.anyOf ?? [schema]).map((option) => this.#resolve(option));
    return alternatives.find((option) => option?.properties?.kind?.const === kind) ?? null;
  }

  /** @returns {Field|null} one parameter of a part (of a kind) */
  field(part, name, kind) {
    const schema = this.#resolve(this.part(part, kind)?.properties?.[name]);
    return schema ? this.#field(name, schema) : null;
  }

  /** @returns {string[]} names of the parameters of a part, in the document's order */
  names(part, kind) {
    return Object.keys(this.part(part, kind)?.properties ?? {}).filter((name) => name !== "kind");
  }

  /** @returns {number} how many items a list may have @param {string} path of the list */
  longest(path) {
    const names = path.split(".");
    const name = names.pop();
    return this.#resolve(this.part(names.join("."))?.properties?.[name])?.maxItems ?? Infinity;
  }

  /** @returns {string[]} the kinds that a part can be of, none if it has one shape */
  kinds(part) {
    const schema = this.part(part);
    const options = (schema?.oneOf ?? schema?.anyOf ?? []).map((option) => this.#resolve(option));
    return options.map((option) => option?.properties?.kind?.const).filter((kind) => kind !== undefined);
  }

  /** @returns {object} a new part of a kind, all at its defaults */
  defaults(part, kind) {
    const values = this.names(part, kind).map((name) => [name, this.field(part, name, kind).default]);
    return { kind, ...structuredClone(Object.fromEntries(values)) };
  }

  /** A list of parts gets a field for each name of a part. */
  #field(name, schema) {
    const item = this.#resolve(schema.items);
    const columns = Object.entries(item?.properties ?? {}).map(([key, own]) => this.#field(key, this.#resolve(own)));
    return new Field(name, schema, columns.length ? columns : null);
  }

  #resolve(schema) {
    if (!schema?.$ref) return schema;
    const { $ref, ...own } = schema;
    return { ...this.root.$defs[$ref.split("/").pop()], ...own };
  }
}

export class Field {
  constructor(name, schema, columns = null) {
    this.name = name;
    this.title = schema.title || name.replaceAll("_", " ");
    this.symbol = schema.symbol || "";
    this.unit = schema.unit || "";
    this.description = schema.description || "";
    this.equation = schema.equation || "";
    this.basis = BASIS[schema.basis] ?? "";
    this.default = schema.default;
    this.isNullable = (schema.anyOf ?? []).some((option) => option.type === "null");
    const bounds = this.isNullable ? schema.anyOf.find((option) => option.type !== "null") : schema;
    this.low = bounds.minimum ?? bounds.exclusiveMinimum ?? -Infinity;
    this.high = bounds.maximum ?? bounds.exclusiveMaximum ?? Infinity;
    this.typical = schema.typical ?? [this.low, this.high];
    this.isLogarithmic = schema.scale === "log" && this.typical[0] > 0;
    this.step = schema.step ?? (this.typical[1] - this.typical[0]) / 100;
    this.isWhole = schema.type === "integer";
    this.choices = schema.type === "boolean" ? [true, false] : (schema.enum ?? null);
    this.isList = schema.type === "array";
    this.longest = schema.maxItems ?? Infinity;
    this.columns = columns;
  }

  /** The same parameter where only a share of its usual size makes sense. */
  scaled(share) {
    const typical = this.typical.map((end) => Number((end * share).toPrecision(3)));
    return Object.assign(Object.create(Field.prototype), this, {
      typical,
      step: Number((this.step * share).toPrecision(3)),
      default: typeof this.default === "number" ? Number((this.default * share).toPrecision(3)) : this.default,
    });
  }
}
