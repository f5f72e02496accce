// Opens another recording: one of the server's list, or a file that is dropped onto the page or chosen, which is sent
// to the server piece by piece. What the server calls recordings is put in as text, never as markup.
"use strict";

(() => {
  const PIECE = 60 * 1024; // bytes of a message: the server takes 256 KiB
  const AHEAD = 4 * 1024 * 1024; // bytes that may wait in this browser
  const PARTS = /\.(mcap|db3)$/;
  const LOOK = 300; // milliseconds between two looks at the list, while it is open

  const made = (tag, name, parent, more = {}) => {
    const element = parent.appendChild(Object.assign(document.createElement(tag), more));
    if (name) element.className = name;
    return element;
  };
  const dialog = made("dialog", "hs-recordings", document.body);
  dialog.setAttribute("aria-label", "Open a recording");
  made("h2", "", dialog, { textContent: "Open a recording" });
  const search = made("input", "hs-recordings-find", dialog, { type: "search", placeholder: "Find a recording" });
  search.setAttribute("aria-label", "Find a recording");
  const list = made("div", "hs-recordings-list", dialog);
  const drop = made("label", "hs-recordings-drop", dialog);
  drop.append("Drop a file or a folder of a recording onto this page, or ");
  const chooser = made("input", "", made("u", "", drop, { textContent: "choose one" }), { type: "file", hidden: true });
  const bar = made("progress", "hs-progress", dialog, { max: 1, hidden: true });
  const status = made("p", "hs-recordings-status", dialog);
  status.setAttribute("role", "status");

  // ----------------------------------------------------------------------------------------------- the list

  const told = () => document.querySelector("[data-hs-library]")?.dataset.hsLibrary;
  const tell = (uuid, value) => window.__viserMutable?.sendMessage?.({ type: "GuiUpdateMessage", uuid, updates: { value } });
  let drawn = "";

  function draw() {
    const now = told();
    const wanted = search.value.trim().toLowerCase();
    if (!now || now + wanted === drawn) return;
    drawn = now + wanted;
    list.replaceChildren();
    let last = "";
    for (const [key, name, group] of JSON.parse(now).recordings) {
      if (!`${group} ${name}`.toLowerCase().includes(wanted)) continue;
      if (group !== last) made("h3", "", list, { textContent: group });
      last = group;
      made("button", "", list, { type: "button", textContent: name }).dataset.hsRecording = key;
    }
    if (!list.childElementCount) made("p", "", list, { textContent: wanted ? "None of them has such a name." : "There are none here: start the program with --folder DIR." });
  }

  function open() {
    if (dialog.open) return;
    status.textContent = "";
    const now = told();
    if (now) tell(JSON.parse(now).list, true);
    draw();
    dialog.showModal();
    search.focus();
  }

  list.addEventListener("click", ({ target }) => {
    if (!target.dataset.hsRecording) return;
    tell(JSON.parse(told()).open, target.dataset.hsRecording);
    dialog.close();
  });
  dialog.addEventListener("click", (event) => event.target === dialog && dialog.close());
  search.addEventListener("input", draw);
  setInterval(() => dialog.open && draw(), LOOK);

  // --------------------------------------------------------------------------------------------- an upload

  let socket = null;

  function ended(text) {
    bar.hidden = true;
    status.textContent = text;
    socket = null;
  }

  async function pump(from, files, total) {
    let sent = 0;
    for (const file of files) {
      for (let at = 0; at < file.size && from.readyState === WebSocket.OPEN; at += PIECE) {
        from.send(await file.slice(at, at + PIECE).arrayBuffer());
        bar.value = (sent += Math.min(PIECE, file.size - at)) / total;
        while (from.bufferedAmount > AHEAD) await new Promise((go) => setTimeout(go, 20));
      }
    }
  }

  function heard(from, files, message) {
    if (message.send) pump(from, files, message.send).catch(() => from.close());
    if (message.refused) ended(message.refused);
    if (message.arrived) {
      ended("");
      dialog.close();
    }
  }

  // One file, or the files of a folder. They are sent one behind the other.
  function send(name, files, said) {
    open();
    if (socket) return;
    status.textContent = `Sending ${name}`;
    Object.assign(bar, { value: 0, hidden: false });
    const address = new URL("upload", location.href);
    address.protocol = address.protocol.replace("http", "ws");
    address.search = address.hash = "";
    const made = (socket = new WebSocket(address));
    made.addEventListener("open", () => made.send(JSON.stringify({ name, ...said })));
    made.addEventListener("message", ({ data }) => heard(made, files, JSON.parse(data)));
    made.addEventListener("close", () => socket === made && ended(`${name} was not sent: the server takes no recordings, or the link broke.`));
  }

  const sendFile = (file) => send(file.name, [file], { size: file.size });

  // Of a rosbag2 folder the server takes the files with messages, in the order of their numbers.
  async function sendFolder(folder) {
    open();
    status.textContent = `Reading ${folder.name}`;
    const [reader, found] = [folder.createReader(), []];
    for (let more = true; more; ) {
      const some = await new Promise((done, failed) => reader.readEntries(done, failed));
      found.push(...some);
      more = some.length > 0;
    }
    const parts = found.filter((each) => each.isFile && PARTS.test(each.name));
    parts.sort((a, b) => a.name.localeCompare(b.name, undefined, { numeric: true }));
    const files = await Promise.all(parts.map((each) => new Promise((done, failed) => each.file(done, failed))));
    if (files.length) return send(folder.name, files, { files: files.map((file) => [file.name, file.size]) });
    ended(`${folder.name} is no rosbag2 folder: it has no .mcap and no .db3 file.`);
  }

  chooser.addEventListener("change", () => {
    if (chooser.files[0]) sendFile(chooser.files[0]);
    chooser.value = "";
  });
  const carries = (event) => event.dataTransfer?.types.includes("Files");
  const over = (shown) => document.documentElement.classList.toggle("hs-dropping", shown);
  addEventListener("dragover", (event) => {
    if (!carries(event)) return;
    event.preventDefault();
    over(true);
  });
  addEventListener("dragleave", (event) => !event.relatedTarget && over(false));
  addEventListener("drop", (event) => {
    if (!carries(event)) return;
    event.preventDefault();
    over(false);
    if (socket) return open();
    const entry = event.dataTransfer.items[0]?.webkitGetAsEntry?.();
    if (entry?.isDirectory) sendFolder(entry).catch(() => ended(`${entry.name} cannot be read.`));
    else if (event.dataTransfer.files[0]) sendFile(event.dataTransfer.files[0]);
  });

  window.hectorscope = Object.assign(window.hectorscope ?? {}, { recordings: open });
})();
