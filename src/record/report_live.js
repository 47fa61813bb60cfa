// Loads the page again; one whose time of writing (data-written) stays behind says that the run has ended.
const live = document.getElementById("live"), wait = live.dataset.period, what = "This " + live.dataset.kind,
      age = Date.now() / 1000 - live.dataset.written;
if (age > 60 + 4 * wait) {
  document.getElementById("now").textContent = what + " has ended before its end, or its steps take long: nothing " +
    "new for " + Math.round(age / 60) + " min. The same command " + live.dataset.again + ". Last state: ";
  live.className = "bad";
} else document.getElementById("now").textContent = what + " goes on: ";
addEventListener("DOMContentLoaded", () => {  // what the reader opened stays open
  const text = document.querySelector("details"), name = location.pathname;
  if (!text) return;
  text.open = sessionStorage.getItem(name) === "open";
  text.ontoggle = () => sessionStorage.setItem(name, text.open ? "open" : "");
});
setTimeout(() => location.reload(), 1000 * wait);
