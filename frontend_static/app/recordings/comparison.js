import { rest } from "../session/rest.js";
import { anchorTime, anchorWords } from "./anchors.js";
import { LIVE, LiveOverlay, RecordedOverlay } from "./overlays.js";
import { RecordedRun } from "./recorded_run.js";
import { addressOf } from "./samples.js";
import { nameOf, originWord } from "./words.js";

/**
 * The runs over the open recording: which, how they are aligned, and how their tunings differ from its own.
 *
 * Event `change`.
 */
export class Comparison extends EventTarget {
  constructor(session) {
    super();
    this.session = session;
    this.facts = null;
    this.open(null, []);
  }

  /** Compare with another recording, with nothing over it. @param {object|null} facts @param {string[]} channels to fetch */
  open(facts, channels) {
    this.facts = facts;
    this.channels = channels;
    this.overlays = [];
    this.anchor = "start";
    this.#changed();
  }

  has(id) {
    return this.overlays.some(({ key }) => key === id);
  }

  /** Lay a recording, or "live", over the open one. @throws {Refusal} */
  async add(id) {
    if (!this.facts || this.has(id) || id === this.facts.id) return;
    const under = this.facts;
    const facts = id === LIVE ? null : await rest("GET", addressOf(id));
    if (this.facts !== under || this.has(id)) return;
    const place = this.overlays.length;
    const overlay = facts ? new RecordedOverlay(new RecordedRun(facts), place) : new LiveOverlay(this.session, place);
    overlay.run?.need(this.channels);
    overlay.run?.addEventListener("change", () => this.dispatchEvent(new Event("change")));
    overlay.name = facts ? [nameOf(facts), originWord(facts)].filter(Boolean).join(", ") : "live";
    overlay.byHand = 0;
    overlay.difference = null;
    this.overlays = [...this.overlays, overlay];
    this.#align();
    this.#compare(overlay);
  }

  remove(id) {
    this.overlays = this.overlays.filter(({ key }) => key !== id);
    this.overlays.forEach((overlay, place) => overlay.place(place));
    this.#changed();
  }

  /** Align all at an anchor (anchors.js). */
  align(anchor) {
    this.anchor = anchor;
    this.#align();
  }

  /** Move one by some more seconds. */
  move(id, seconds) {
    this.overlays.find(({ key }) => key === id).byHand = seconds;
    this.#align();
  }

  #align() {
    const own = anchorTime(this.facts, this.anchor);
    for (const overlay of this.overlays) {
      const shift = own - anchorTime(overlay.facts, this.anchor);
      overlay.shift = (Number.isNaN(shift) ? 0 : shift) + overlay.byHand;
      overlay.problem = Number.isNaN(shift) ? `It has no ${anchorWords(this.anchor)}: aligned at t = 0.` : "";
    }
    this.#changed();
  }

  async #compare(overlay) {
    try {
      const { changes, same } = await rest("GET", addressOf(this.facts.id, "difference", { against: overlay.key }));
      overlay.difference = same ? ["same tuning"] : changes.map(({ words }) => words);
    } catch (refusal) {
      overlay.difference = [refusal.message];
    }
    this.#changed();
  }

  #changed() {
    this.dispatchEvent(new Event("change"));
  }
}
