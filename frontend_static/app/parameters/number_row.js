import { element } from "../element.js";
import { inputText, readNumber } from "../quantity.js";
import { ParameterRow } from "./parameter_row.js";
import { SliderScale } from "./slider_scale.js";
import { SliderStream } from "./slider_stream.js";

const LONG_UNIT = 7;
const NOTHING = "none";

/** A number: slider, box and unit. Where the field may be empty, an empty box is “none”, and the slider's far end. */
export class NumberRow extends ParameterRow {
  #isDragging = false;
  #isTyping = false;

  constructor(field, place, hint) {
    const label = `${field.title}${field.unit ? `, ${field.unit}` : ""}`;
    const slider = element("input", {
      type: "range",
      min: 0,
      max: SliderScale.positions,
      step: 1,
      "aria-label": label,
    });
    const box = element("input", {
      type: "text",
      inputmode: "decimal",
      autocomplete: "off",
      spellcheck: "false",
      "aria-label": label,
      placeholder: field.isNullable ? NOTHING : null,
    });
    super(field, place, hint, [
      slider,
      box,
      element(
        "span",
        { class: field.unit.length > LONG_UNIT ? "row-unit is-long" : "row-unit", title: field.unit },
        field.unit,
      ),
    ]);
    this.slider = slider;
    this.box = box;
    this.scale = new SliderScale(field);
    this.stream = new SliderStream((value) => this.send(value).finally(() => this.settle()));
    this.#listenToSlider();
    this.#listenToBox();
  }

  get isBusy() {
    return this.#isDragging || this.#isTyping || this.stream.isWaiting;
  }

  words(value) {
    if (value === null) return NOTHING;
    return typeof value === "number"
      ? `${inputText(value)}${this.field.unit ? ` ${this.field.unit}` : ""}`
      : String(value);
  }

  show(value) {
    this.box.value = inputText(value);
    this.box.removeAttribute("aria-invalid");
    this.#place(value);
  }

  #place(value) {
    this.slider.value = value === null ? SliderScale.positions : this.scale.position(value);
    this.slider.classList.toggle("is-empty", value === null);
    this.slider.style.setProperty("--share", this.slider.value / SliderScale.positions);
    this.slider.setAttribute("aria-valuetext", this.words(value));
  }

  #listenToSlider() {
    const { slider } = this;
    slider.addEventListener("pointerdown", () => (this.#isDragging = true));
    slider.addEventListener("input", () => {
      const value = this.scale.value(Number(slider.value));
      slider.style.setProperty("--share", slider.value / SliderScale.positions);
      slider.classList.remove("is-empty");
      this.box.value = inputText(value);
      this.#move(value);
    });
    const release = () => {
      this.#isDragging = false;
      if (this.place.restarts) this.#commit();
      else this.settle();
    };
    slider.addEventListener("blur", () => this.#commit());
    slider.addEventListener("change", release);
    slider.addEventListener("pointerup", release);
    slider.addEventListener("pointercancel", release);
    slider.addEventListener("keydown", (event) => (event.key === "Enter" ? this.#commit() : this.#stepByKey(event)));
    slider.addEventListener("dblclick", () => this.reset());
  }

  #listenToBox() {
    const { box } = this;
    box.addEventListener("focus", () => box.select());
    box.addEventListener("input", () => {
      this.#isTyping = true;
      box.removeAttribute("aria-invalid");
    });
    box.addEventListener("blur", () => this.#commit());
    box.addEventListener("keydown", (event) => {
      if (event.key === "Enter") this.#commit();
      else this.#stepByKey(event, ["ArrowUp", "ArrowDown"]);
    });
  }

  #stepByKey(event, keys = ["ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight"]) {
    if (!keys.includes(event.key)) return;
    event.preventDefault();
    const direction = event.key === "ArrowUp" || event.key === "ArrowRight" ? 1 : -1;
    const size = event.shiftKey ? 10 : event.altKey ? 0.1 : 1;
    const from = readNumber(this.box.value);
    const value = this.scale.stepped(Number.isNaN(from) ? (this.echoed ?? this.scale.low) : from, direction * size);
    this.#isTyping = false;
    this.show(value);
    this.#move(value);
  }

  /** Send a value on its way; where each one restarts the run, only keep it until the hand leaves the control. */
  #move(value) {
    if (this.place.restarts) this.#isTyping = true;
    else this.stream.move(value);
  }

  async #commit() {
    if (!this.#isTyping) return;
    this.#isTyping = false;
    const typed = this.box.value;
    const value = this.field.isNullable && typed.trim() === "" ? null : readNumber(typed);
    if (value !== null && !Number.isFinite(value)) {
      this.show(this.echoed);
      this.say(`“${typed.trim()}” is not a number; kept ${this.words(this.echoed)}`, "refused");
    } else if (Object.is(value, this.echoed)) this.show(value);
    else if (!(await this.send(value)) && this.root.contains(document.activeElement)) {
      this.box.setAttribute("aria-invalid", "true");
    }
  }
}
