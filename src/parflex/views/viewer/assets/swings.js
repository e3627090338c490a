// Small motions about an equilibrium: instant 0 of each array is at rest, the two after it of each motion are a
// quarter of a period apart, as they are drawn at amplitude 1. `state.time` is the part of the period, 0 to 1.

function swungBy(size = state.amplitude) {
  const angle = 2 * Math.PI * state.time;
  if (meta.swings[state.swing].ramp) return { real: (size * (1 - Math.cos(angle))) / 2, imaginary: 0 };
  return { real: size * Math.cos(angle), imaginary: size * Math.sin(angle) };
}

function swung(name) {
  const all = array[name], width = all.length / count, at = 1 + 2 * state.swing;
  // the platform's bend is made larger when it is drawn
  const { real, imaginary } = swungBy(name === "elastic" ? 1 : state.amplitude);
  return Float64Array.from({ length: width }, (_, k) => all[k]
    + real * (all[at * width + k] - all[k]) - imaginary * (all[(at + 1) * width + k] - all[k]));
}

function choose(k) {
  state.swing = Math.min(meta.swings.length - 1, Math.max(0, k));
  document.querySelectorAll("#swings.choose tbody tr").forEach((row, j) => {
    row.classList.toggle("chosen", j === state.swing);
    if (j === state.swing) row.scrollIntoView({ block: "nearest" });
  });
  draw();
}

function listSwings() {
  element("slider").setAttribute("aria-label", "part of the motion");
  if (meta.swings[0].ramp) return;
  element("swings").classList.add("choose");
  document.querySelectorAll("#swings tbody tr").forEach((row, k) => row.addEventListener("click", () => choose(k)));
  choose(0);
}

function swingKey(event) {
  const step = { ArrowDown: 1, ArrowRight: 1, ArrowUp: -1, ArrowLeft: -1 }[event.key];
  if (!step || meta.swings[0].ramp) return false;
  event.preventDefault();
  choose(state.swing + step);
  return true;
}

function long(metres) {
  const [factor, unit] = metres >= 1e-3 ? [1e3, "mm"] : metres >= 1e-7 ? [1e6, "µm"] : [1e9, "nm"];
  return `${+(factor * metres).toPrecision(3)} ${unit}`;
}

function tellSwing() {
  const { title, hertz, ramp, most, factor } = meta.swings[state.swing];
  const times = (value) => (+value.toPrecision(2)).toLocaleString("en");
  element("clock").textContent = title;
  const slow = hertz / state.speed;
  const pace = slow >= 1 ? `${times(slow)} times slower than it is` : `${times(1 / slow)} times faster than it is`;
  element("largest").textContent = ramp
    ? `drawn ${times(state.amplitude * factor)} times larger than it is; at most ${long(most / factor)}`
    : `${pace}; larger than life, up to ${long(state.amplitude * most)}: a mode has no size of its own`;
}

// the colours of a load are in its own units; of a mode, in parts of its largest displacement
function swingLegend(of) {
  const { ramp, most, factor } = meta.swings[state.swing];
  if (!ramp) return { factor: 1 / most, words: ", in parts of the largest motion" };
  const [size, unit] = most / factor >= 1e-3 ? [1e3, "mm"] : most / factor >= 1e-7 ? [1e6, "µm"] : [1e9, "nm"];
  return { factor: size / factor, words: ` (${unit})` };
}
