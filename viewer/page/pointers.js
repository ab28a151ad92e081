// Mouse, pen and fingers on the picture: one drags, two zoom too. `dragged` and `zoomAt` are those of the camera.
function watchView(canvas, changed) {
  const pointers = new Map();
  const middle = () => {
    const all = [...pointers.values()];
    const x = all.reduce((sum, p) => sum + p.x, 0) / all.length, y = all.reduce((sum, p) => sum + p.y, 0) / all.length;
    return { x, y, spread: all.length > 1 ? Math.hypot(all[0].x - all[1].x, all[0].y - all[1].y) : 0 };
  };
  const local = (event) => {
    const box = canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  };
  canvas.addEventListener("contextmenu", (event) => { if (D === 3) event.preventDefault(); });
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, local(event));
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!pointers.has(event.pointerId)) return;
    const old = middle();
    pointers.set(event.pointerId, local(event));
    const now = middle();
    dragged(now.x - old.x, now.y - old.y, pointers.size > 1 || event.shiftKey || event.buttons > 1);
    if (old.spread > 0 && now.spread > 0) zoomAt(now.x, now.y, now.spread / old.spread);
    changed();
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (e) => pointers.delete(e.pointerId));
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const p = local(event);
    zoomAt(p.x, p.y, Math.exp(-0.0015 * event.deltaY));
    changed();
  }, { passive: false });
  canvas.addEventListener("dblclick", () => { fit(); changed(); });
}
