import { Refusal, notConnected } from "./refusal.js";

const SUBPROTOCOL = "vssea-1";
const SILENCE_LIMIT_MS = 4000; // the server speaks twice a second
const COMMAND_LIMIT_MS = 6000;
const RETRY_MS = [500, 1000, 2000, 4000, 8000];

/**
 * The live websocket: it reconnects by itself, notices silence, and fails every pending command when the link is lost.
 *
 * Events: `open`, `lost` (detail: {why, retryAt}), `retrying`, `message` (detail: object), `frame` (detail: ArrayBuffer).
 */
export class LiveConnection extends EventTarget {
  #socket = null;
  #pending = new Map();
  #nextId = 1;
  #failures = 0;
  #silence = null;
  #retry = null;

  /** @param {() => number} historySeconds how much history to ask for at each connect */
  constructor(historySeconds) {
    super();
    this.historySeconds = historySeconds;
    this.isOpen = false;
  }

  open() {
    clearTimeout(this.#retry);
    const url = new URL("/api/live", location.href);
    url.protocol = location.protocol === "https:" ? "wss:" : "ws:";
    url.searchParams.set("history_s", this.historySeconds());
    const socket = new WebSocket(url, SUBPROTOCOL);
    socket.binaryType = "arraybuffer";
    this.#socket = socket;
    this.#watchSilence();
    this.dispatchEvent(new Event("retrying"));
    socket.onmessage = ({ data }) => socket === this.#socket && this.#receive(data);
    socket.onclose = ({ reason }) =>
      socket === this.#socket && this.#lose(reason || "The server closed the connection.");
  }

  /** Send a command, to be answered within `limitMs`. @returns {Promise<object>} its result @throws {Refusal} */
  command(name, args = {}, limitMs = COMMAND_LIMIT_MS) {
    if (!this.isOpen) return Promise.reject(notConnected());
    const id = this.#nextId++;
    return new Promise((resolve, reject) => {
      const limit = setTimeout(() => {
        this.#pending.delete(id);
        reject(
          new Refusal({ title: "No answer", detail: `No answer to “${name}” within ${limitMs / 1000} s.` }),
        );
      }, limitMs);
      this.#pending.set(id, { resolve, reject, limit });
      this.#socket.send(JSON.stringify({ id, command: name, arguments: args }));
    });
  }

  #receive(data) {
    this.#watchSilence();
    if (typeof data !== "string") return this.#emit("frame", data);
    const message = JSON.parse(data);
    if (message.type === "reply") return this.#settle(message);
    if (message.type === "hello") {
      this.isOpen = true;
      this.#failures = 0;
      this.dispatchEvent(new Event("open"));
    }
    this.#emit("message", message);
  }

  #settle({ id, ok, result, problem }) {
    const waiting = this.#pending.get(id);
    if (!waiting) return;
    this.#pending.delete(id);
    clearTimeout(waiting.limit);
    if (ok) waiting.resolve(result ?? {});
    else waiting.reject(new Refusal(problem));
  }

  #watchSilence() {
    clearTimeout(this.#silence);
    this.#silence = setTimeout(
      () => this.#lose(`Nothing heard from the server for ${SILENCE_LIMIT_MS / 1000} s.`),
      SILENCE_LIMIT_MS,
    );
  }

  #lose(why) {
    const socket = this.#socket;
    this.#socket = null;
    this.isOpen = false;
    clearTimeout(this.#silence);
    socket?.close();
    for (const { reject, limit } of this.#pending.values()) {
      clearTimeout(limit);
      reject(notConnected());
    }
    this.#pending.clear();
    const wait = RETRY_MS[Math.min(this.#failures++, RETRY_MS.length - 1)];
    this.#retry = setTimeout(() => this.open(), wait);
    this.#emit("lost", { why, retryAt: performance.now() + wait });
  }

  #emit(type, detail) {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }
}
