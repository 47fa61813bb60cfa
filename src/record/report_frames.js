// The slider of the frames.
const box = document.getElementById("frames"), line = box.querySelector("input"), picture = box.querySelector("img");
const all = JSON.parse(document.getElementById("pictures").textContent);
const show = () => { const [address, words] = all[line.value]; picture.src = address; picture.alt = words;
                     line.ariaValueText = box.querySelector("figcaption").textContent = words; };
let playing = 0;
line.oninput = show;
box.querySelector("button").onclick = () => {
  if (playing) { clearInterval(playing); playing = 0; return; }
  if (line.value == line.max) line.value = 0;
  playing = setInterval(() => { if (line.value == line.max) { clearInterval(playing); playing = 0; } else line.value++;
                                show(); }, 250);
};
addEventListener("beforeprint", () => { line.value = line.max; show(); });
