// Whatever goes wrong, the page says it.
window.parflexFailed = (error) => {
  const banner = document.getElementById("banner");
  const line = document.createElement("li");
  line.textContent = `The robot cannot be drawn by this browser: ${error?.message ?? error}`;
  banner.hidden = false;
  banner.querySelector("ul").append(line);
  document.getElementById("loading")?.remove();
  console.error(error);
};
document.addEventListener("DOMContentLoaded", () => {
  if (!document.createElement("canvas").getContext("webgl2")) window.parflexFailed("it has no WebGL 2");
});
