import { isActive, isPreparing } from "./words.js";

/** Show how far a batch is; a bar without an end while it prepares. @param {HTMLProgressElement} bar @param {object} batch */
export function showProgress(bar, batch) {
  bar.hidden = !isActive(batch);
  if (isPreparing(batch)) bar.removeAttribute("value");
  else bar.value = batch.progress?.share ?? 0;
}
