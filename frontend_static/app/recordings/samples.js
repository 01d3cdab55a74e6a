import { Refusal } from "../session/refusal.js";

const TIME_LIMIT_MS = 30_000;

/** @returns {string} address of one recording's resource, such as "samples" */
export function addressOf(id, resource = "", query = {}) {
  const given = Object.entries(query).filter(([, value]) => value !== null && value !== undefined);
  const asked = given.length ? `?${new URLSearchParams(given)}` : "";
  return `/api/recordings/${encodeURIComponent(id)}${resource ? `/${resource}` : ""}${asked}`;
}

/**
 * Samples of a recording, as docs/protocol.md describes the answer of …/samples.
 *
 * @param {string} id @param {{channels: string[], from_s: number, to_s: number, points: number}} asked
 * @param {AbortSignal} [signal]
 * @returns {Promise<Samples>} @throws {Refusal}
 */
export async function fetchSamples(id, { channels, ...span }, signal) {
  const limit = AbortSignal.timeout(TIME_LIMIT_MS);
  const response = await fetch(addressOf(id, "samples", { channels: channels.join(), ...span }), {
    signal: signal ? AbortSignal.any([signal, limit]) : limit,
  });
  if (!response.ok) throw new Refusal(await response.json().catch(() => ({ detail: `It answered ${response.status}.` })));
  return new Samples(await response.arrayBuffer());
}

/** A picture of a recording: exact samples, or the least and the greatest of equal spans of time. */
export class Samples {
  #columns;
  #nothing = null;

  /** @param {ArrayBuffer} buffer the answer of the server */
  constructor(buffer) {
    const length = new DataView(buffer).getUint32(0, true);
    const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
    const rows = head.samples;
    const begin = 4 + length;
    this.isExact = head.exact;
    this.period = head.period_s;
    this.of = head.of;
    this.time = new Float64Array(buffer, begin, rows);
    this.#columns = new Map(
      head.channels.map((name, i) => [name, new Float32Array(buffer, begin + 8 * rows + 4 * rows * i, rows)]),
    );
  }

  static get none() {
    const header = new TextEncoder().encode('{"samples":0,"exact":true,"channels":[]}'.padEnd(44));
    const buffer = new ArrayBuffer(4 + header.length);
    new DataView(buffer).setUint32(0, header.length, true);
    new Uint8Array(buffer, 4).set(header);
    return new Samples(buffer);
  }

  /** @returns {Float32Array} a channel's samples; NaN for one that was not recorded */
  column(name) {
    if (this.#columns.has(name)) return this.#columns.get(name);
    this.#nothing ??= new Float32Array(this.time.length).fill(NaN);
    return this.#nothing;
  }

  /** Add a channel that was computed from others. */
  add(name, values) {
    this.#columns.set(name, values);
  }

  has(name) {
    return this.#columns.has(name);
  }
}
