import { commandedStiffness } from "../document/commanded_stiffness.js";

/**
 * What is analysed: the live scenario on the controller's own model or on the simulated actuator, at the commanded stiffness
 * or at another one, and at which further stiffnesses.
 *
 * Event `change`.
 */
export class Subject extends EventTarget {
  constructor(document) {
    super();
    this.document = document;
    this.plant = "model";
    this.chosenStiffness = null;
    this.overlays = new Set();
  }

  /** @returns {number|undefined} N m/rad */
  get stiffness() {
    return this.chosenStiffness ?? commandedStiffness(this.document);
  }

  /** @returns {object} body of a request, without what else is asked */
  get request() {
    const { plant, chosenStiffness } = this;
    return chosenStiffness === null ? { plant } : { plant, stiffness: chosenStiffness };
  }

  choosePlant(plant) {
    this.plant = plant;
    this.#changed();
  }

  /** @param {number|null} stiffness N m/rad; null follows the commanded one */
  chooseStiffness(stiffness) {
    this.chosenStiffness = stiffness;
    this.#changed();
  }

  toggleOverlay(stiffness) {
    if (!this.overlays.delete(stiffness)) this.overlays.add(stiffness);
    this.#changed();
  }

  #changed() {
    this.dispatchEvent(new Event("change"));
  }
}
