"use strict";
const Answer = { running: 0, done: 1, badScenario: 2, failed: 3 }; // as in engine.cpp
const element = id => document.getElementById(id);
const colour = name => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();

// --- numbers with units ---

const prefixes = { "-12": "p", "-9": "n", "-6": "µ", "-3": "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T" };
const exponentOf = value => value === 0 ? 0 : Math.max(-12, Math.min(12, 3 * Math.floor(Math.log10(Math.abs(value) * (1 + 1e-12)) / 3)));
const shown = (value, unit, digits = 4) => {
  const exponent = exponentOf(value);
  return Number((value / 10 ** exponent).toPrecision(digits)) + "\u00a0" + prefixes[exponent] + unit; // on one line
};

// --- the text of a scenario ---

// Sets the key at the path "table.key", "table[1].key" or "key" to the text of a value; a key that is not there becomes the first of its
// table. The scenarios of this page have each value on one line.
function withKey(toml, path, value) {
  const dot = path.lastIndexOf("."), table = path.slice(0, Math.max(dot, 0)), key = path.slice(dot + 1);
  const [, name, number] = /^(.*?)(?:\[(\d+)\])?$/.exec(table);
  const header = number === undefined ? `[${name}]` : `[[${name}]]`;
  const lines = toml.split("\n");
  let start = 0;
  if (table) {
    const found = lines.flatMap((line, i) => line.trim().startsWith(header) ? [i] : []);
    if (found.length <= Number(number ?? 0)) return toml + `\n${header}\n${key} = ${value}\n`;
    start = found[Number(number ?? 0)] + 1;
  }
  let end = lines.findIndex((line, i) => i >= start && /^\s*\[/.test(line));
  if (end < 0) end = lines.length;
  const at = lines.findIndex((line, i) => i >= start && i < end && new RegExp(`^\\s*${key}\\s*=`).test(line));
  if (at >= 0) lines[at] = lines[at].replace(/=.*$/, "= " + value);
  else if (table) lines.splice(start, 0, `${key} = ${value}`);
  else lines.splice(lines.findIndex(line => /^\s*knap\s*=/.test(line)) + 1, 0, `${key} = ${value}`);
  return lines.join("\n");
}

const valueText = (slider, [, change = 1], value) => typeof change === "function" ? change(value)
  : slider.unit ? `"${Number((value * change).toPrecision(6))} ${slider.unit}"` : String(value);

// --- the state of the page ---

let scene, run = 0, latest, curve = [], view, lastText = "";
let worker, ready;

const post = message => ready.then(() => worker.postMessage(message));

async function moduleBytes() {
  const packed = Uint8Array.from(atob(knapModule), c => c.charCodeAt(0));
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
}

function startWorker() {
  worker = new Worker(URL.createObjectURL(new Blob([`(${knapWorker})()`], { type: "text/javascript" })));
  ready = new Promise((resolve, reject) => {
    worker.onmessage = ({ data }) => data.ready ? resolve() : receive(data);
    worker.onerror = event => {
      const text = "This browser cannot run the module: it needs WebAssembly with exceptions and vectors (Chromium 95, Firefox 113, Safari 16.4).\n" +
        (event.message ?? "");
      finish(text), say(text);
      reject(new Error(text));
    };
    moduleBytes().then(bytes => worker.postMessage({ bytes }), () => worker.onerror({}));
  });
  ready.catch(() => {});
}

function say(text) {
  element("messages").textContent = text;
  element("messages").hidden = !text;
}

function choose(chosen) {
  stop();
  scene = chosen;
  for (const button of element("scenes").children) button.setAttribute("aria-current", String(button.textContent === scene.title));
  element("title").textContent = scene.title;
  const toml = knapScenarios[scene.name];
  element("question").textContent = /^#\s*(.*)$/m.exec(toml)[1];
  element("see").textContent = scene.see;
  element("deform").textContent = scene.deform === 1 ? "" : `Displacements are drawn ${scene.deform} times as large.`;
  element("scenario").value = toml;
  element("sliders").replaceChildren(...scene.sliders.map(sliderOf));
  latest = undefined, curve = [], say("");
  element("status").textContent = "Press Run.";
  element("progress").value = 0;
  draw();
}

function sliderOf(slider) {
  const label = document.createElement("label"), name = document.createElement("span"), output = document.createElement("output"),
    input = document.createElement("input");
  name.textContent = slider.label;
  Object.assign(input, { type: "range", min: 0, max: slider.values.length - 1, step: 1, value: slider.values.indexOf(slider.value) });
  input.dataset.key = slider.keys[0][0];
  const apply = () => {
    const value = slider.values[input.value], text = `${value} ${slider.unit}`.trim();
    output.textContent = text;
    input.setAttribute("aria-valuetext", text);
    for (const key of slider.keys) element("scenario").value = withKey(element("scenario").value, key[0], valueText(slider, key, value));
  };
  input.addEventListener("input", apply);
  input.addEventListener("change", startRun);
  apply();
  label.append(name, output, input);
  return label;
}

function startRun() {
  ++run;
  latest = undefined, curve = [], view = undefined, lastText = "";
  say("");
  element("status").textContent = "Meshing …";
  element("run").textContent = "Run again", element("stop").disabled = false;
  element("progress").value = 0;
  post({ start: element("scenario").value, deform: scene.deform, run });
}

function finish(text) {
  element("status").textContent = text;
  element("stop").disabled = true;
}

function stop() {
  if (element("stop").disabled) return;
  ++run;
  post({ stop: true });
  finish("Stopped.");
}

function receive({ run: of, answer, text, seconds, numbers, history, frame, summary }) {
  if (frame) worker.postMessage({ drawn: true });
  if (of !== run) return;
  if (text) say(lastText += text);
  if (numbers) {
    latest = { numbers, frame };
    curve.push(...history, numbers);
    element("progress").value = numbers.time / numbers.end;
    requestAnimationFrame(draw);
  }
  const computed = `computed in ${seconds.toFixed(1)}\u00a0s`;
  if (answer === Answer.running) {
    if (numbers) element("status").textContent = `Computes: ${shown(numbers.time, "s")} of ${shown(numbers.end, "s")}, ${computed}.`;
  } else if (answer === Answer.done) {
    finish(`Done: ${shown(numbers.time, "s")} in ${numbers.steps} steps, ${computed}.`);
  } else {
    finish(answer === Answer.badScenario ? "The scenario has errors, see the messages below." : "The run ended early, see the messages below.");
  }
  window.knapResult = { answer, text: lastText, numbers: numbers ?? latest?.numbers, summary, seconds };
}

// --- drawing ---

function sized(canvas, height) {
  const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth;
  canvas.style.height = height + "px";
  canvas.width = Math.round(width * ratio), canvas.height = Math.round(height * ratio);
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  return [pen, width, height];
}

// The box of the body at the start, with room; it grows when pieces leave it.
function fitted(corners) {
  let [x0, y0, x1, y1] = view?.inner ?? [Infinity, Infinity, -Infinity, -Infinity];
  for (let i = 0; i < corners.length; i += 2) {
    x0 = Math.min(x0, corners[i]), x1 = Math.max(x1, corners[i]);
    y0 = Math.min(y0, corners[i + 1]), y1 = Math.max(y1, corners[i + 1]);
  }
  const room = 0.04 * Math.max(x1 - x0, y1 - y0);
  view = { inner: [x0, y0, x1, y1], x: x0 - room, y: y1 + room, width: x1 - x0 + 2 * room, height: y1 - y0 + 2 * room };
}

const levels = 33; // of the colour scale: compression, nothing, tension
function palette() {
  const parse = name => colour(name).match(/[0-9a-f]{2}/gi).map(h => parseInt(h, 16));
  const [low, middle, high] = ["compression", "middle", "tension"].map(parse);
  return Array.from({ length: levels }, (_, k) => {
    const s = 2 * k / (levels - 1) - 1, end = s < 0 ? low : high;
    return `rgb(${middle.map((m, c) => Math.round(m + Math.abs(s) * (end[c] - m))).join()})`;
  });
}

function drawBody() {
  const canvas = element("body");
  if (!latest) {
    const [pen, width] = sized(canvas, Math.round(canvas.clientWidth * 0.5));
    pen.clearRect(0, 0, width, width);
    return;
  }
  const { corners, stress, cracks, states, obstacles, outline } = latest.frame;
  fitted(corners);
  const height = Math.min(canvas.clientWidth * view.height / view.width, 0.85 * window.innerHeight);
  const [pen, width] = sized(canvas, Math.round(height));
  const scale = Math.min(width / view.width, height / view.height);
  const left = (width - scale * view.width) / 2;
  const X = x => left + scale * (x - view.x), Y = y => scale * (view.y - y);
  pen.clearRect(0, 0, width, height);
  pen.fillStyle = colour("obstacle");
  for (let k = 0; k < obstacles.length; k += 2 * outline) {
    pen.beginPath();
    for (let i = 0; i < outline; ++i) pen.lineTo(X(obstacles[k + 2 * i]), Y(obstacles[k + 2 * i + 1]));
    pen.fill();
  }
  const colours = palette(), paths = colours.map(() => new Path2D());
  for (let t = 0; t < stress.length; ++t) {
    const s = Math.max(-1, Math.min(1, stress[t] / (1e6 * scene.stress)));
    const path = paths[Math.round((s + 1) / 2 * (levels - 1))], c = 6 * t;
    path.moveTo(X(corners[c]), Y(corners[c + 1]));
    path.lineTo(X(corners[c + 2]), Y(corners[c + 3]));
    path.lineTo(X(corners[c + 4]), Y(corners[c + 5]));
    path.closePath();
  }
  pen.lineWidth = 0.6; // covers the seams between neighbours
  paths.forEach((path, k) => {
    pen.fillStyle = pen.strokeStyle = colours[k];
    pen.fill(path), pen.stroke(path);
  });
  const lines = { 3: ["notch", 1.5], 1: ["damaged", 1.2], 2: ["broken", 1.8] }; // InterfaceStatus
  pen.lineCap = "round";
  for (const state of [3, 1, 2]) {
    pen.strokeStyle = colour(lines[state][0]), pen.lineWidth = lines[state][1];
    pen.beginPath();
    states.forEach((of, i) => {
      if (of === state) pen.moveTo(X(cracks[4 * i]), Y(cracks[4 * i + 1])), pen.lineTo(X(cracks[4 * i + 2]), Y(cracks[4 * i + 3]));
    });
    pen.stroke();
  }
  canvas.setAttribute("aria-label", `The body at ${shown(latest.numbers.time, "s")}: ${shown(latest.numbers.brokenLength, "m")} of broken edges`);
}

function drawScale() {
  const [pen, width] = sized(element("scale"), 34), colours = palette(), wide = Math.min(width, 360);
  colours.forEach((c, k) => { pen.fillStyle = c, pen.fillRect(wide * k / levels, 4, wide / levels + 1, 10); });
  pen.fillStyle = colour("soft"), pen.font = "12px system-ui, sans-serif";
  [[-1, "left"], [0, "center"], [1, "right"]].forEach(([s, align]) => {
    pen.textAlign = align;
    pen.fillText(s === 0 ? "0: largest principal stress" : `${s * scene.stress} MPa`, wide * (s + 1) / 2, 28);
  });
  element("scale").setAttribute("aria-label", `Colour: largest principal stress, ${-scene.stress} MPa (blue) to ${scene.stress} MPa (red)`);
}

const terms = [["external work", n => n.externalWork, "ink", [6, 4]], ["kinetic", n => n.kinetic, "compression", []],
  ["elastic", n => n.strain, "tension", []], ["dissipated by fracture", n => n.dissipated, "damaged", []],
  ["lost by friction", n => -n.frictionWork, "notch", [2, 3]]];

const tickStep = range => {
  const raw = range / 4, power = 10 ** Math.floor(Math.log10(raw));
  return power * [1, 2, 5, 10].find(m => m * power >= raw);
};

function drawEnergy() {
  const canvas = element("energy"), [pen, width, height] = sized(canvas, 230);
  pen.clearRect(0, 0, width, height);
  element("legend").replaceChildren();
  if (!curve.length) return;
  const used = terms.filter(([name, of]) => name !== "lost by friction" || curve.some(n => of(n) > 0));
  const top = Math.max(1e-30, ...curve.flatMap(n => used.map(([, of]) => of(n)))), bottom = Math.min(0, ...curve.flatMap(n => used.map(([, of]) => of(n))));
  const end = curve[0].end, left = 52, right = width - 16, low = height - 34, high = 10;
  const X = t => left + (right - left) * t / end, Y = e => low - (low - high) * (e - bottom) / (top - bottom);
  pen.font = "12px system-ui, sans-serif", pen.fillStyle = colour("soft"), pen.strokeStyle = colour("line"), pen.lineWidth = 1;
  const axis = (last, first, unit, each) => {
    const step = tickStep(last - first), exponent = exponentOf(Math.max(last, -first));
    for (let k = Math.ceil(first / step - 1e-9); k * step <= last * (1 + 1e-9); ++k) each(k * step, String(Number((k * step / 10 ** exponent).toPrecision(6))));
    return prefixes[exponent] + unit;
  };
  pen.textAlign = "center";
  const timeUnit = axis(end, 0, "s", (t, text) => {
    pen.beginPath(), pen.moveTo(X(t), low), pen.lineTo(X(t), high), pen.stroke();
    pen.fillText(text, X(t), low + 14);
  });
  pen.textAlign = "right";
  const energyUnit = axis(top, bottom, "J", (e, text) => {
    pen.beginPath(), pen.moveTo(left, Y(e)), pen.lineTo(right, Y(e)), pen.stroke();
    pen.fillText(text, left - 4, Y(e) + 4);
  });
  pen.fillText(`time [${timeUnit}]`, right, height - 4);
  pen.save(), pen.translate(12, high), pen.rotate(-Math.PI / 2), pen.fillText(`energy [${energyUnit}]`, 0, 0), pen.restore();
  for (const [name, of, ink, dash] of used) {
    pen.strokeStyle = colour(ink), pen.lineWidth = 1.8, pen.setLineDash(dash);
    pen.beginPath();
    for (const n of curve) pen.lineTo(X(n.time), Y(of(n)));
    pen.stroke();
    const key = document.createElement("span"), mark = document.createElement("span");
    mark.className = "mark", mark.style.borderColor = colour(ink), mark.style.borderTopStyle = dash.length ? "dashed" : "solid";
    mark.style.marginRight = ".3rem";
    key.append(mark, name);
    element("legend").append(key);
  }
  pen.setLineDash([]);
  canvas.setAttribute("aria-label", "Energies over time, at the end: " + used.map(([name, of]) => `${name} ${shown(of(curve.at(-1)), "J")}`).join(", "));
}

function drawNumbers() {
  const rows = latest ? (n => [["Simulated time", shown(n.time, "s")], ["Triangles", String(n.triangles)], ["Steps", String(n.steps)],
    ["Length of broken edges", shown(n.brokenLength, "m")], ["Dissipated by fracture", shown(n.dissipated, "J")],
    ["Thickness of the body", shown(n.thickness, "m")],
    ["Largest error of the energy balance, of the largest energy", n.residual.toExponential(1)]])(latest.numbers) : [];
  element("numbers").tBodies[0].replaceChildren(...rows.map(([name, value]) => {
    const row = document.createElement("tr"), head = document.createElement("th"), cell = document.createElement("td");
    head.scope = "row", head.textContent = name, cell.textContent = value;
    row.append(head, cell);
    return row;
  }));
}

function draw() { drawBody(), drawScale(), drawEnergy(), drawNumbers(); }

// --- the page ---

for (const one of scenes) {
  const button = document.createElement("button");
  button.type = "button", button.textContent = one.title;
  button.addEventListener("click", () => { choose(one), startRun(); });
  element("scenes").append(button);
}
element("run").addEventListener("click", startRun);
element("stop").addEventListener("click", stop);
element("reset").addEventListener("click", () => choose(scene));
element("sliders").addEventListener("submit", event => event.preventDefault());
/// What a scene expects is of its own values: of others the program would report it as missed.
function savedScenario() {
  const text = element("scenario").value;
  if (text === knapScenarios[scene.name]) return text;
  return text.replace(/^\[expect\][^\n]*\n(?:(?!\[)[^\n]*\n?)*/m, "# [expect] was of other values, and is left out\n");
}

element("download").addEventListener("click", () => {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([savedScenario()], { type: "application/toml" }));
  link.download = scene.name + ".toml";
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
});
window.addEventListener("resize", draw);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
// A reload keeps the scene and the text of its scenario.
addEventListener("pagehide", () => sessionStorage.setItem("scene", JSON.stringify([scene.name, element("scenario").value])));
const [keptName, keptText] = JSON.parse(sessionStorage.getItem("scene") ?? "[]");
startWorker();
choose(scenes.find(one => one.name === keptName) ?? scenes[0]);
if (keptText !== undefined && keptText !== element("scenario").value) {
  element("scenario").value = keptText;
  element("status").textContent = "Press Run: the scenario is the one before the page was loaded again; Reset values gives that of the sliders.";
}
