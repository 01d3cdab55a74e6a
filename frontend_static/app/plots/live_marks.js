import { markOf } from "./event_marks.js";

const MARKS_KEPT = 500;

/** The marks of the session's present run. */
export class LiveMarks {
  constructor(session) {
    this.list = [];
    session.addEventListener("log", ({ detail }) => this.#add(detail, session));
    session.store.addEventListener("cleared", () => this.#forget(session.store.epoch));
  }

  #add(events, session) {
    const newest = Math.max(...events.map((event) => event.epoch ?? 0), session.store.epoch ?? 0, this.epoch ?? 0);
    this.epoch = newest;
    const marks = events.map((event) => markOf(event, session.you)).filter((mark) => mark !== null);
    this.list = [...this.list, ...marks].filter((mark) => mark.epoch === newest).slice(-MARKS_KEPT);
  }

  /** Events of a new epoch may be told before its first sample. */
  #forget(epoch) {
    this.list = this.list.filter((mark) => mark.epoch > epoch);
    this.epoch = 0;
  }
}
