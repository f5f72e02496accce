// The message over the scene: it stays where the scene is, also while the panels are folded away. Text is put in as
// text, never as markup.
"use strict";

(() => {
  const box = document.createElement("div");
  box.className = "hs-message";
  box.setAttribute("role", "status");
  box.setAttribute("aria-live", "polite");
  const parts = ["symbol", "title", "detail"].map((name) => {
    const part = box.appendChild(document.createElement(name === "symbol" ? "i" : name === "title" ? "b" : "span"));
    part.className = `hs-message-${name}`;
    return [name, part];
  });

  function place() {
    const canvas = document.querySelector("canvas[data-engine]")?.getBoundingClientRect();
    if (!canvas?.width) return;
    box.style.left = `${canvas.left + canvas.width / 2}px`;
    box.style.bottom = `${innerHeight - canvas.bottom + 28}px`;
    box.style.maxWidth = `${Math.max(220, canvas.width - 48)}px`;
  }

  function tell(message) {
    if (!box.isConnected) document.body.append(box);
    box.hidden = !message;
    if (!message) return;
    box.dataset.hsKind = message.kind;
    box.classList.toggle("hs-brief", !message.detail);
    for (const [name, part] of parts) if (part.textContent !== message[name]) part.textContent = message[name];
    place();
  }

  addEventListener("resize", place);
  window.hectorscope = Object.assign(window.hectorscope ?? {}, { tell });
})();
