import { LiveConnection } from "./live_connection.js";
import { callAs } from "./rest.js";
import { TelemetryFrame } from "./telemetry_frame.js";
import { TelemetryStore } from "./telemetry_store.js";
import { ScenarioDocument } from "../document/scenario_document.js";

const EVENTS_KEPT = 300;

/**
 * The page's one picture of the session: snapshot, document, events and telemetry, all as the server said them.
 *
 * Events: `snapshot`, `hello`, `log` (the list of events changed), `connection` (open or lost), `presets`, `margins` (of the
 * tuning, newly computed), `batches` (news of one that runs), and those of `document` and `store`.
 */
export class LiveSession extends EventTarget {
  #run = null; // which run of the server the samples and events came from

  /** @param {string[]} channels names of the channels to keep @param {() => number} historySeconds */
  constructor(channels, historySeconds) {
    super();
    this.store = new TelemetryStore(channels);
    this.document = new ScenarioDocument();
    this.connection = new LiveConnection(historySeconds);
    this.snapshot = null;
    this.margins = null;
    this.tuningId = null; // of the document
    this.events = [];
    this.channels = new Map();
    this.you = "";
    this.loss = null;
    this.connection.addEventListener("message", ({ detail }) => this.#take(detail));
    this.connection.addEventListener("frame", ({ detail }) => this.store.accept(new TelemetryFrame(detail)));
    this.connection.addEventListener("lost", ({ detail }) => this.#connectionIs(detail));
    this.connection.addEventListener("retrying", () =>
      this.#connectionIs(this.loss && { ...this.loss, retryAt: null }),
    );
    this.connection.addEventListener("open", () => this.#connectionIs(null));
  }

  get isConnected() {
    return this.connection.isOpen;
  }

  /** What the session does, and why, with “you” for this page. */
  get sentence() {
    return (this.snapshot?.sentence ?? "").replace(`by ${this.you} `, "by you ");
  }

  start() {
    this.connection.open();
  }

  command(name, args, limitMs) {
    return this.connection.command(name, args, limitMs);
  }

  /** Add a line to the log that only this page knows of, such as a refused command. */
  note(text, severity = "warning") {
    this.#log([
      {
        number: null,
        wall_time: new Date().toISOString(),
        epoch: null,
        time_s: null,
        kind: "page",
        text,
        by: this.you,
        severity,
      },
    ]);
  }

  #connectionIs(loss) {
    this.loss = loss;
    this.dispatchEvent(new Event("connection"));
  }

  #take(message) {
    if (message.type === "hello") this.#greet(message);
    else if (message.type === "state") this.#show(message.snapshot);
    else if (message.type === "document") this.#takeDocument(message);
    else if (message.type === "margins") this.#takeMargins(message);
    else if (message.type === "event") this.#log([message.event]);
    else if (message.type === "recordings") this.dispatchEvent(new Event("recordings"));
    else if (message.type === "batches") this.dispatchEvent(new CustomEvent("batches", { detail: message }));
    else if (message.type === "missed") this.note(`${message.samples} samples missed: this page was too slow`);
  }

  #greet(hello) {
    const otherRun = this.#run !== null && hello.run !== this.#run;
    if (otherRun) this.store.clear({ restarted: true });
    this.#run = hello.run;
    this.you = hello.you;
    callAs(hello.you);
    this.channels = new Map(hello.channels.map((channel) => [channel.name, channel]));
    this.store.readChannels(hello.channels);
    this.events = otherRun ? [] : this.events;
    this.dispatchEvent(new Event("hello"));
    if (hello.document) this.#takeDocument(hello.document);
    this.#takeMargins(hello.margins ?? null);
    this.#log(hello.events);
    this.#show(hello.snapshot);
  }

  #show(snapshot) {
    this.snapshot = snapshot;
    this.dispatchEvent(new Event("snapshot"));
  }

  #takeDocument(message) {
    this.tuningId = message.tuning_id ?? null;
    this.document.accept(message);
  }

  #takeMargins(margins) {
    this.margins = margins;
    this.dispatchEvent(new Event("margins"));
  }

  #log(events) {
    const known = new Set(this.events.map(identity));
    const fresh = events.filter((event) => !known.has(identity(event)));
    if (!fresh.length) return;
    this.events = [...this.events, ...fresh].slice(-EVENTS_KEPT);
    this.dispatchEvent(new CustomEvent("log", { detail: fresh }));
    if (fresh.some((event) => event.kind === "preset")) this.dispatchEvent(new Event("presets"));
  }
}

/** A restarted server counts its events anew, so the number alone does not tell them apart. */
function identity({ number, wall_time, text }) {
  return `${number} ${wall_time} ${text}`;
}
