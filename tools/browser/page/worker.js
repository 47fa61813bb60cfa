"use strict";
// The thread that computes. The page makes it from the text of this function, since a page that was opened as a file may load no
// worker from another one. Messages to it: {bytes}, {start: TOML, deform, run}, {stop}, {drawn}; from it: {ready}, {run, answer, text,
// seconds, numbers, history, frame, summary}.
function knapWorker() {
  const numberNames = ["time", "end", "steps", "triangles", "kinetic", "strain", "dissipated", "recoverable", "externalWork", "frictionWork",
    "residual", "brokenLength", "thickness"];
  const Answer = { running: 0, done: 1, failed: 3 };
  const slice = 40; // [ms] of computing between two looks at messages
  let module, knap, memory, printed = "";
  let current = 0, deform = 1, drawn = true;

  const text = address => {
    const bytes = new Uint8Array(memory.buffer, address);
    return new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0)));
  };
  // What the C library asks of its system: a clock and a place for messages of assertions; it has no files.
  const nothing = 0, badDescriptor = 8;
  const system = {
    fd_write(descriptor, parts, n, written) {
      const view = new DataView(memory.buffer);
      let total = 0;
      for (let i = 0; i < n; ++i) {
        const at = view.getUint32(parts + 8 * i, true), size = view.getUint32(parts + 8 * i + 4, true);
        printed += new TextDecoder().decode(new Uint8Array(memory.buffer, at, size).slice());
        total += size;
      }
      view.setUint32(written, total, true);
      return nothing;
    },
    clock_time_get(clock, precision, at) {
      new DataView(memory.buffer).setBigUint64(at, BigInt(Math.round(performance.now() * 1e6)), true);
      return nothing;
    },
    environ_sizes_get(n, size) {
      const view = new DataView(memory.buffer);
      view.setUint32(n, 0, true), view.setUint32(size, 0, true);
      return nothing;
    },
    environ_get: () => nothing,
    proc_exit(code) { throw new Error("the program ended with code " + code); },
  };
  const systemWithoutFiles = new Proxy(system, { get: (known, name) => known[name] ?? (() => badDescriptor), has: () => true });

  const instantiate = () => {
    const imports = {};
    for (const { name } of WebAssembly.Module.imports(module)) imports[name] = systemWithoutFiles[name];
    knap = new WebAssembly.Instance(module, { wasi_snapshot_preview1: imports }).exports;
    memory = knap.memory, printed = "";
    knap._initialize();
  };
  // A failed assertion, or memory beyond what the browser gives, leaves the instance in no state to go on.
  const guarded = call => {
    try {
      const answer = call();
      return [answer, text(knap.knap_text())];
    } catch (error) {
      const what = printed.trim() || String(error);
      instantiate();
      return [Answer.failed, "internal error, or not enough memory: " + what + "\nA larger mesh.size needs less memory.\n"];
    }
  };
  const numbers = () => {
    const values = new Float64Array(memory.buffer, knap.knap_numbers(), numberNames.length);
    return Object.fromEntries(numberNames.map((name, i) => [name, values[i]]));
  };
  const frame = () => {
    const [corners, cracks, obstacles, outline] = new Int32Array(memory.buffer, knap.knap_sizes(), 4);
    const floats = (address, n) => new Float32Array(memory.buffer, address, n).slice();
    return {
      corners: floats(knap.knap_corners(), 2 * corners), stress: floats(knap.knap_stress(), corners / 3), cracks: floats(knap.knap_cracks(), 4 * cracks),
      states: new Uint8Array(memory.buffer, knap.knap_states(), cracks).slice(), obstacles: floats(knap.knap_obstacles(), 2 * obstacles * outline), outline,
    };
  };
  let history = []; // numbers since the last message
  const report = (answer, said, withFrame) => {
    const message = { run: current, answer, text: said, seconds: spent / 1000 };
    if (withFrame) {
      knap.knap_show(deform);
      message.frame = frame(), message.numbers = numbers(), message.history = history;
      history = [], drawn = false, shownAt = performance.now();
    }
    if (answer === Answer.done) knap.knap_summary(), message.summary = JSON.parse(text(knap.knap_text()));
    postMessage(message);
  };

  // A run is shown in so many frames, each for so long at least [ms], so that one that takes less time than the eye is seen.
  const frames = 120, shownFor = 25;
  let reached, spent, shownAt;
  const turns = new MessageChannel(); // messages of the page come between two slices
  const turn = run => {
    if (run !== current) return;
    const start = performance.now(), { end } = numbers(), until = end * reached / frames;
    const [answer, said] = guarded(() => knap.knap_advance(slice, until));
    spent += performance.now() - start;
    if (answer !== Answer.running) {
      report(answer, said, knap.knap_has_run() !== 0);
      current = 0;
      return;
    }
    const now = numbers(), isFrame = now.time >= until;
    if (isFrame) history.push(now), reached = 1 + Math.floor(now.time / end * frames * (1 + 1e-12));
    if (isFrame && drawn) report(answer, said, true);
    else if (said) report(answer, said, false);
    const early = isFrame ? shownFor - (performance.now() - shownAt) : 0;
    if (early > 1) setTimeout(() => turn(run), early);
    else turns.port2.postMessage(run);
  };
  turns.port1.onmessage = ({ data: run }) => turn(run);
  onmessage = ({ data }) => {
    if (data.bytes) {
      module = new WebAssembly.Module(data.bytes);
      instantiate();
      postMessage({ ready: true });
    } else if (data.drawn) {
      drawn = true;
    } else if (data.stop) {
      current = 0;
    } else {
      current = data.run, deform = data.deform;
      const bytes = new TextEncoder().encode(data.start);
      const begin = performance.now();
      const [answer, said] = guarded(() => {
        const at = knap.knap_memory(bytes.length);
        new Uint8Array(memory.buffer, at, bytes.length).set(bytes);
        return knap.knap_start(at, bytes.length);
      });
      spent = performance.now() - begin, reached = 1, history = [], drawn = true;
      report(answer, said, answer === Answer.running);
      if (answer === Answer.running) turns.port2.postMessage(current);
      else current = 0;
    }
  };
}
