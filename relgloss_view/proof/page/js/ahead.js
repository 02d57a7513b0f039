// The programs of a first picture, begun before it can be drawn: browsers compile beside the page's own script.

import { blocksOf } from "./reduction.js";

/** Begin to compile what a picture needs of every side, without waiting. allPasses: by side. */
export function beginPictures(device, allPasses, settings, size) {
  for (const [name, passes] of Object.entries(allPasses)) {
    const request = passes.request(settings, name, size);
    for (const [stage, defines] of stagesOf(passes, request)) device.begin(stage, defines);
  }
}

// [[stage, constants], ...] of a request, in the order in which they are drawn.
function stagesOf(passes, request) {
  const { variant, seen, samples } = request;
  const [first, ...further] = blocksOf(request.size);
  const stages = passes.surface?.stages?.(request) ?? [];
  const reduced = (stage) => further.map((block) => [stage, { BLOCK: block }]);
  stages.push(["white.frag", { BLOCK: first, ...variant.white, ...seen }], ...reduced("peak.frag"));
  if (variant.reads_field) stages.push(["grain_field.frag", variant.field]);
  stages.push(["shade.frag", passes.shadeDefines(request)]);
  if (!variant.splits) stages.push(["split.frag", variant.split]);
  stages.push(["measure.frag", { BLOCK: first, STRIDE: 1 }], ...reduced("reduce.frag"));
  const smooth = passes.display.edges === "smooth" && samples === 1;
  if (smooth && passes.side.shape.analytic) stages.push(["coverage.frag", { ...variant.shape, ...seen }]);
  else if (smooth) stages.push(["mesh_edge.frag", {}], ["mesh_places.frag", {}]);
  stages.push(["tone.frag", passes.display.tone[samples > 1 ? "several" : "one"]]);
  if (smooth) stages.push(["edge.frag", passes.display.edge]);
  return stages;
}
