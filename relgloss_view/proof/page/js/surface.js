// What draws packs and forms of triangles; shapes that rays meet need none of it.

/** The form of a side, or null where rays meet its shape: see passes.js for what a form gives. */
export async function openForm(_device, _drawing, _name, _files) {
  return null;
}
