// Buttons, keys, speeds.

const BUTTONS = [
  ["forces", "forces", () => scene.arrows.some((a) => a.kind !== "joint")],
  ["joints", "joint forces", () => scene.arrows.some((a) => a.kind === "joint")],
  ["velocities", "velocities", () => reach.velocity > 0],
  ["trails", "trails", () => !still && (scene.bands.length > 0 || scene.frames.some((f) => f.velocity))],
  ["names", "names", () => scene.frames.some((f) => f.label) || scene.bands.length > 0],
];

function addShows() {
  const box = document.getElementById("shows");
  for (const [key, text, there] of BUTTONS) {
    if (!there()) continue;
    const button = document.createElement("button");
    button.textContent = text;
    button.setAttribute("aria-pressed", shows[key]);
    button.addEventListener("click", () => {
      shows[key] = !shows[key];
      button.setAttribute("aria-pressed", shows[key]);
      redraw();
    });
    box.append(button);
  }
  if (D === 3) box.append(sideSelect());
  if (scene.frames.length > 1 && !still) box.append(followSelect());
}

function followSelect() {
  const select = document.createElement("select");
  select.id = "follow";
  select.title = "What the picture stays with";
  select.setAttribute("aria-label", "Follow a body");
  select.add(new Option("fixed view", 0));
  scene.frames.forEach((frame, k) => { if (frame.velocity) select.add(new Option(`follow ${frame.name}`, k)); });
  select.addEventListener("change", () => {
    camera.follow = Number(select.value);
    if (!camera.follow) fit();
    redraw();
  });
  return select;
}

function addLegend() {
  const banded = scene.bands.filter((band) => band.fields.length);
  if (!banded.length) return;
  const names = [...new Set(banded.flatMap((band) => band.fields.map((field) => field.name)))];
  const box = document.getElementById("legend"), select = document.createElement("select");
  const bar = document.createElement("i"), ends = document.createElement("div");
  select.setAttribute("aria-label", "What the colours of flexible bodies mean");
  const unitOf = (name) => banded.flatMap((band) => band.fields).find((field) => field.name === name).unit;
  for (const name of names) select.add(new Option(`${name} (${unitOf(name)})`, name));
  select.add(new Option("no colours", ""));
  select.value = banded[0].fields[0].name;
  const choose = () => {
    let limit = 0;
    for (const band of banded) {
      const k = band.fields.findIndex((field) => field.name === select.value);
      chosen.set(band, k);
      if (k >= 0) limit = Math.max(limit, band.fields[k].limit);
    }
    // one scale for all bodies
    for (const band of banded) if (band.fields[chosen.get(band)]) band.fields[chosen.get(band)].limit = limit;
    ends.replaceChildren(...(select.value ? [-limit, 0, limit] : []).map((v) => Object.assign(document.createElement("span"), { textContent: shown(v, "") })));
    bar.hidden = !select.value;
    redraw();
  };
  select.addEventListener("change", choose);
  box.append(select, bar, ends);
  box.hidden = false;
  choose();
}

function speedText(speed) {
  return speed >= 1 ? `${Number(speed.toPrecision(3))}×` : `1/${Number((1 / speed).toPrecision(3))}×`;
}

// Real time where that takes some seconds, else about eight seconds for all.
function addSpeeds() {
  const select = document.getElementById("speed"), duration = last - first, wanted = duration / 8;
  const steps = [];
  for (let power = -7; power <= 3; power++) for (const n of [1, 2, 5]) steps.push(n * 10 ** power);
  const near = duration >= 2 && duration <= 20 ? 1 : steps.reduce((a, b) => (Math.abs(Math.log(b / wanted)) < Math.abs(Math.log(a / wanted)) ? b : a));
  const centre = steps.findIndex((s) => Math.abs(s / near - 1) < 1e-9);
  steps.forEach((s, k) => { if (Math.abs(k - centre) <= 7) select.add(new Option(speedText(s), s)); });
  state.speed = steps[centre];
  select.selectedIndex = [...select.options].findIndex((o) => Number(o.value) === state.speed);
  select.addEventListener("change", () => { state.speed = Number(select.value); });
}

function changeSpeed(by) {
  const select = document.getElementById("speed");
  select.selectedIndex = Math.max(0, Math.min(select.options.length - 1, select.selectedIndex + by));
  state.speed = Number(select.value);
}

// Clicks and drags on a canvas over time.
function watchTime(canvas, timeOf) {
  let held = false;
  const go = (event) => seek(timeOf(event.clientX - canvas.getBoundingClientRect().left));
  canvas.addEventListener("pointerdown", (event) => {
    held = true;
    canvas.setPointerCapture(event.pointerId);
    state.resume = state.playing;
    pause();
    go(event);
  });
  canvas.addEventListener("pointermove", (event) => { if (held) go(event); });
  for (const end of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(end, () => {
      if (held && state.resume) play();
      held = false;
    });
  }
}

function watchKeys() {
  document.addEventListener("keydown", (event) => {
    if (["SELECT", "INPUT"].includes(event.target.tagName) || event.ctrlKey || event.metaKey || event.altKey) return;
    const back = event.key === "ArrowLeft";
    if (event.key === " " && event.target.tagName !== "BUTTON") state.playing ? pause() : play();
    else if (back || event.key === "ArrowRight") {
      pause();
      if (event.shiftKey) seek(neighbour(state.time, !back));
      else seek(state.time + (back ? -1 : 1) * (last - first) / 200);
    } else if (event.key === "Home") seek(first);
    else if (event.key === "End") seek(last);
    else if (event.key === "[" || event.key === "]") changeSpeed(event.key === "[" ? -1 : 1);
    else if (event.key === "+" || event.key === "-") zoomMiddle(event.key === "+" ? 1.25 : 0.8);
    else if (event.key === "0") { fit(); redraw(); }
    else return;
    event.preventDefault();
  });
}

function zoomMiddle(factor) {
  zoomAt(0.5 * camera.width, 0.5 * camera.height, factor);
  redraw();
}
