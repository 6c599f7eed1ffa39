// node spine.mjs FOLDER: Esoteric's runtime poses puppet.json; prints the largest distance from expected.json in pixels.
// Needs @esotericsoftware/spine-core 4.2 in node_modules of the current folder. For tests only: it may not be shipped.
import fs from "node:fs";
import path from "node:path";
import { pathToFileURL } from "node:url";
const core = path.resolve("node_modules/@esotericsoftware/spine-core");
const main = JSON.parse(fs.readFileSync(path.join(core, "package.json"))).main;
const spine = await import(pathToFileURL(path.join(core, main)));
const folder = process.argv[2];
const expected = JSON.parse(fs.readFileSync(path.join(folder, "expected.json")));
const atlas = new spine.TextureAtlas(fs.readFileSync(path.join(folder, "puppet.atlas"), "utf8"));
for (const page of atlas.pages) page.setTexture(new spine.FakeTexture({ width: page.width, height: page.height }));
const json = new spine.SkeletonJson(new spine.AtlasAttachmentLoader(atlas));
const data = json.readSkeletonData(fs.readFileSync(path.join(folder, "puppet.json"), "utf8"));
const skeleton = new spine.Skeleton(data);
let worst = 0;
const judge = (meshes) => {
  skeleton.updateWorldTransform(spine.Physics.none);
  skeleton.drawOrder.forEach((slot, k) => {
    const mesh = skeleton.getAttachmentByName(slot.data.name, slot.data.name); // hidden ones too
    if (!slot.getAttachment()) slot.setAttachment(mesh);
    const out = new Float32Array(mesh.worldVerticesLength);
    mesh.computeWorldVertices(slot, 0, out.length, out, 0, 2);
    meshes[k].forEach(([x, y], v) => (worst = Math.max(worst, Math.hypot(out[2 * v] - x, out[2 * v + 1] - y))));
  });
};
for (const { turned, meshes } of expected.poses) {
  skeleton.setToSetupPose();
  for (const [name, degrees] of Object.entries(turned)) skeleton.findBone(name).rotation += degrees;
  judge(meshes);
}
for (const { name, time, meshes } of expected.moments) {
  skeleton.setToSetupPose();
  data.findAnimation(name).apply(skeleton, 0, time, false, null, 1, spine.MixBlend.setup, spine.MixDirection.mixIn);
  judge(meshes);
}
console.log(JSON.stringify({ worst, slots: skeleton.slots.length, bones: skeleton.bones.length, version: data.version }));
