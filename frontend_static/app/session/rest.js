import { Refusal } from "./refusal.js";

const TIME_LIMIT_MS = 8000;
let page = "";

/** Let calls from now on be those of a page, by the name that the live session gave it: the log says who did what. */
export function callAs(name) {
  page = name;
}

/** One REST call, answered within `timeLimitMs`. @param {object|string} [body] a string is sent as it is @param {Object<string, string>} [headers] such as If-Match @returns {Promise<any>} the answer's JSON @throws {Refusal} with the server's problem, or why there is none */
export async function rest(method, path, body, timeLimitMs = TIME_LIMIT_MS, headers = {}) {
  let response;
  const own = { ...(page && { "x-vssea-page": page }), ...(body !== undefined && { "content-type": "application/json" }) };
  try {
    response = await fetch(path, {
      method,
      headers: { ...own, ...headers },
      body: body === undefined || typeof body === "string" ? body : JSON.stringify(body),
      signal: AbortSignal.timeout(timeLimitMs),
    });
  } catch (error) {
    const why =
      error.name === "TimeoutError" ? `no answer within ${timeLimitMs / 1000} s` : "the server cannot be reached";
    throw new Refusal({ title: "No answer", detail: `${method} ${path}: ${why}.` });
  }
  if (response.status === 204) return null;
  const answer = await response.json().catch(() => undefined);
  if (!response.ok)
    throw new Refusal(answer?.detail ? answer : { detail: `${method} ${path} answered ${response.status}.` });
  if (answer === undefined)
    throw new Refusal({ title: "No answer", detail: `${method} ${path}: the answer broke off. Try again.` });
  return answer;
}
