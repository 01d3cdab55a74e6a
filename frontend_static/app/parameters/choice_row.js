import { wordOf } from "./choice_word.js";
import { ParameterRow } from "./parameter_row.js";
import { Segmented } from "./segmented.js";

/** One of a few words, or yes and no. */
export class ChoiceRow extends ParameterRow {
  constructor(field, place, hint) {
    const options = field.choices.map((value) => ({ value, text: wordOf(value, place.words) }));
    const segmented = new Segmented(field.title, options, (value) => this.send(value));
    super(field, place, hint, [segmented.root]);
    this.root.classList.add("row-choice");
    this.segmented = segmented;
    this.special = place.words;
  }

  get isBusy() {
    return false;
  }

  words(value) {
    return wordOf(value, this.special);
  }

  show(value) {
    this.segmented.show(value);
  }
}
