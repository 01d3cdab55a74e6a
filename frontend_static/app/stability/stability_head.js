import { element, setText } from "../element.js";

const REST_MS = 1200;

/**
 * The sentence on top of the column: the nearest danger, always visible. It is told to screen readers once the tuning
 * rests, not at each step of a slider.
 */
export class StabilityHead {
  #resting = null;

  constructor(column) {
    this.announcement = document.getElementById("stability-announcement");
    this.sentence = element("p", { id: "stability-sentence" });
    this.handle = element(
      "button",
      {
        type: "button",
        id: "stability-handle",
        "aria-controls": "side",
        "aria-expanded": "false",
        click: () => this.#toggle(column),
      },
      "Margins",
    );
    this.root = element("div", { id: "stability-head", "data-tone": "none" }, this.handle, this.sentence);
  }

  /** @param {object|null} margins the server's newest message */
  show(margins) {
    const { tone, text } = verdict(margins);
    this.root.dataset.tone = tone;
    setText(this.sentence, text);
    this.sentence.title = text;
    clearTimeout(this.#resting);
    const announced = tone === "ample" && !this.announcement.textContent ? "" : text;
    this.#resting = setTimeout(() => setText(this.announcement, announced), REST_MS);
  }

  #toggle(column) {
    const isOpen = column.dataset.open !== "true";
    column.dataset.open = String(isOpen);
    this.handle.setAttribute("aria-expanded", String(isOpen));
  }
}

function verdict(margins) {
  if (!margins) return { tone: "none", text: "The margins are being computed." };
  if (!margins.available) return { tone: "none", text: `No margins: ${margins.reason}.` };
  if (!margins.stable) return { tone: "unstable", text: sentence(margins.warning?.sentence ?? "the closed loop is unstable") };
  if (margins.warning) return { tone: "warning", text: sentence(margins.warning.sentence) };
  return { tone: "ample", text: "Stable; no margin is thin." };
}

function sentence(words) {
  return `${words[0].toUpperCase()}${words.slice(1)}.`;
}
