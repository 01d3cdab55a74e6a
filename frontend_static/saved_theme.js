/* Runs before the first paint, so that a saved theme does not flash. The rest of it is app/theme.js. */
(() => {
  const saved = localStorage.getItem("vssea.theme");
  if (saved === "dark" || saved === "light") document.documentElement.dataset.theme = saved;
})();
