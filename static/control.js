// What this page may do: an operator's page acts while it is in control, a viewer's never does. The server refuses all
// else whatever a page sends (web/roles.py); this only shows it.
"use strict";

(() => {
  const AGAIN = 2000; // milliseconds; the connection may be a new one
  const root = document.documentElement;
  let role = "operator";
  let bar = null;

  const send = (message) => window.__viserMutable?.sendMessage?.(message);
  fetch("role", { cache: "no-store" }).then((answer) => (answer.ok ? answer.text() : role)).then((word) => {
    role = word;
    root.dataset.hsRole = role;
    if (role === "viewer") show("You are a viewer: this page only looks.", false);
  }).catch(() => null);

  function show(words, offer) {
    if (!bar) {
      bar = document.createElement("div");
      bar.className = "hs-control";
      bar.setAttribute("role", "status");
      bar.append(document.createElement("span"), document.createElement("button"));
      bar.lastChild.textContent = "Take control";
      bar.lastChild.addEventListener("click", () => send({ type: "HectorscopeTakeControl" }));
      document.body.append(bar);
    }
    bar.firstChild.textContent = words;
    bar.lastChild.hidden = !offer;
    bar.hidden = !words;
  }

  // Called by the server each second, with the number of the page in control; null if none is.
  function inControl(page) {
    if (role === "viewer") return;
    const mine = page === null || page === window.hectorscope.pageNumber;
    root.dataset.hsRole = mine ? "operator" : "waiting";
    show(mine ? "" : "Another operator is in control.", !mine);
  }

  setInterval(() => send({ type: "HectorscopePage", page: window.hectorscope.pageNumber }), AGAIN);
  Object.assign(window.hectorscope, { inControl });
})();
