import { commandedStiffness } from "../document/commanded_stiffness.js";
import { element, setText } from "../element.js";
import { Segmented } from "../parameters/segmented.js";
import { compact, inputText, readNumber } from "../quantity.js";
import { OVERLAYS, overlayColour } from "./overlay_colours.js";

const MOST = 1e5;

/** What is analysed, and when: plant, stiffness, further stiffnesses, following the tuning or not. */
export class SubjectPanel {
  constructor(subject, analysis) {
    this.subject = subject;
    this.analysis = analysis;
    this.plant = new Segmented(
      "Plant",
      [
        { value: "model", text: "its model", title: "The plant that the controller believes in" },
        { value: "actuator", text: "the actuator", title: "The true parameters of the simulated actuator" },
      ],
      (plant) => subject.choosePlant(plant),
    );
    this.stiffness = element("input", {
      type: "text",
      inputmode: "decimal",
      autocomplete: "off",
      "aria-label": "Stiffness, N·m/rad; empty for the commanded one",
      change: () => this.#takeStiffness(),
    });
    this.problem = element("p", { class: "form-problem", role: "status", hidden: true });
    this.chips = OVERLAYS.map((stiffness) => this.#chip(stiffness));
    this.follow = element("input", { type: "checkbox", checked: true, change: () => analysis.follow(this.follow.checked) });
    this.compute = element("button", { type: "button", click: () => analysis.ask() }, "Compute");
    this.state = element("span", { class: "hint" });
    this.overlayRow = row("also at", element("div", { class: "chips", role: "group", "aria-label": "Further stiffnesses, N·m/rad" }, ...this.chips));
    this.followRow = element(
      "div",
      { class: "form-row follow-row" },
      element("label", {}, this.follow, " follow the tuning"),
      this.state,
      this.compute,
    );
    this.root = element(
      "section",
      { class: "side-panel", "aria-label": "What is analysed" },
      element("h2", {}, "The live loop"),
      row("on", this.plant.root),
      row("stiffness", this.stiffness, element("span", { class: "form-unit" }, "N·m/rad")),
      this.problem,
      this.overlayRow,
      this.followRow,
    );
    for (const source of [subject, subject.document, analysis]) source.addEventListener("change", () => this.#show());
    this.#show();
  }

  /** Further stiffnesses and following are for the loop section only. */
  showFor(section) {
    this.overlayRow.hidden = this.followRow.hidden = section !== "loop";
  }

  #chip(stiffness) {
    const swatch = element("span", { class: "chip-swatch" });
    swatch.style.background = `var(--${overlayColour(stiffness)})`;
    return element(
      "button",
      {
        type: "button",
        class: "chip",
        "data-stiffness": stiffness,
        "aria-pressed": "false",
        click: () => this.subject.toggleOverlay(stiffness),
      },
      swatch,
      String(stiffness),
    );
  }

  #takeStiffness() {
    const text = this.stiffness.value.trim();
    const value = text === "" ? null : readNumber(text);
    const isGood = value === null || (value > 0 && value <= MOST);
    this.problem.hidden = isGood;
    this.stiffness.setAttribute("aria-invalid", String(!isGood));
    if (isGood) this.subject.chooseStiffness(value);
    else setText(this.problem, `“${text}” is no stiffness; expected a number above 0 up to ${MOST} N·m/rad, or nothing.`);
  }

  #show() {
    const { subject, analysis } = this;
    this.plant.show(subject.plant);
    const commanded = commandedStiffness(subject.document);
    this.stiffness.placeholder = commanded === undefined ? "as commanded" : `${compact(commanded)}, commanded`;
    if (document.activeElement !== this.stiffness && this.problem.hidden)
      this.stiffness.value = subject.chosenStiffness === null ? "" : inputText(subject.chosenStiffness);
    for (const chip of this.chips)
      chip.setAttribute("aria-pressed", String(subject.overlays.has(Number(chip.dataset.stiffness))));
    setText(this.state, analysis.isBusy ? "computing…" : analysis.isOld ? "changed" : "current");
    this.compute.disabled = analysis.isBusy || !analysis.isOld;
  }
}

/** One line of a form in the left column. */
export function row(name, ...controls) {
  return element("div", { class: "form-row" }, element("span", { class: "form-name" }, name), ...controls);
}
