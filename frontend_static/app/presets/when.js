const TIME = new Intl.DateTimeFormat("en-GB", { hour: "2-digit", minute: "2-digit" });
const DAY = new Intl.DateTimeFormat("en-GB", { day: "numeric", month: "short", hour: "2-digit", minute: "2-digit" });
const YEAR = new Intl.DateTimeFormat("en-GB", { day: "numeric", month: "short", year: "numeric" });

/** @returns {string} when something was saved, in as few words as tell it: 14:03; 3 Jan, 14:03; 3 Jan 2024 */
export function when(iso, now = new Date()) {
  const then = new Date(iso);
  if (Number.isNaN(then.getTime())) return iso;
  if (then.toDateString() === now.toDateString()) return TIME.format(then);
  return then.getFullYear() === now.getFullYear() ? DAY.format(then) : YEAR.format(then);
}

/** @returns {string} when and by whom */
export function whenBy({ saved_at: at, author }) {
  return author ? `${when(at)}, ${author}` : when(at);
}
