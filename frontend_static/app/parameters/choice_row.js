import { CHOICE_WORDS } from "../layout.js";
import { ParameterRow } from "./parameter_row.js";
import { Segmented } from "./segmented.js";

/** One of a few words, or yes and no. */
export class ChoiceRow extends ParameterRow {
  constructor(field, place, hint) {
    const options = field.choices.map((value) => ({ value, text: CHOICE_WORDS[value] ?? String(value) }));
    const segmented = new Segmented(field.title, options, (value) => this.send(value));
    super(field, place, hint, [segmented.root]);
    this.root.classList.add("row-choice");
    this.segmented = segmented;
  }

  get isBusy() {
    return false;
  }

  words(value) {
    return CHOICE_WORDS[value] ?? String(value);
  }

  show(value) {
    this.segmented.show(value);
  }
}
