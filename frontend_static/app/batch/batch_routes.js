import { rest } from "../session/rest.js";
import { Refusal } from "../session/refusal.js";

const LONG_MS = 60_000;

/** @returns {string} address of one batch's resource, such as "results" */
export function batchAddress(id, resource = "", query = {}) {
  const asked = new URLSearchParams(query).toString();
  return `/api/batches/${encodeURIComponent(id)}${resource ? `/${resource}` : ""}${asked ? `?${asked}` : ""}`;
}

/** The server's batches, as docs/protocol.md lists the routes. Each may throw a Refusal. */
export const batchRoutes = {
  estimate: (document) => rest("POST", "/api/batches/estimate", document, LONG_MS),
  create: (document, key) => rest("POST", "/api/batches", document, LONG_MS, { "Idempotency-Key": key }),
  list: (query) => rest("GET", `/api/batches?${new URLSearchParams(query)}`),
  batch: (id) => rest("GET", batchAddress(id)),
  document: (id) => rest("GET", batchAddress(id, "document")),
  cancel: (id) => rest("POST", batchAddress(id, "cancel")),
  resume: (id) => rest("POST", batchAddress(id, "resume")),
  remove: (id) => rest("DELETE", batchAddress(id)),
  results: (id, query) => rest("GET", batchAddress(id, "results", query), undefined, LONG_MS),
  run: (id, run) => rest("GET", batchAddress(id, `runs/${run}`), undefined, LONG_MS),
  scenario: (id, run) => rest("GET", batchAddress(id, `runs/${run}/scenario`), undefined, LONG_MS),
};

/** @returns {Promise<ArrayBuffer>} the trajectory of a run, simulated anew: telemetry frames @throws {Refusal} */
export async function simulateRun(id, run, signal) {
  let response;
  try {
    response = await fetch(batchAddress(id, `runs/${run}/simulate`), { method: "POST", signal: AbortSignal.any([signal, AbortSignal.timeout(LONG_MS)]) });
  } catch (error) {
    if (signal.aborted) throw error;
    throw new Refusal({ detail: "The run could not be simulated: the server cannot be reached. Choose it again." });
  }
  if (!response.ok) throw new Refusal(await response.json().catch(() => ({ detail: `The simulation answered ${response.status}.` })));
  return response.arrayBuffer();
}
