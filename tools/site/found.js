// A hit of the search leads to a page, whose words Sphinx marks: this goes to the first of them.
addEventListener("load", () => setTimeout(() => {
  if (!location.hash) document.querySelector("div.body span.highlighted")?.scrollIntoView({ block: "center" });
}, 100));
