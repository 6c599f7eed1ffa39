// node dragonbones.mjs FOLDER: the DragonBones runtime (Cocos' fork) poses puppet_ske.json; prints the largest distance
// from expected.json in pixels. Needs @cocos/dragonbones-js in node_modules of the current folder. The blend below is
// what its adapters for engines do with the runtime's own arrays.
import fs from "node:fs";
import path from "node:path";
const file = "node_modules/@cocos/dragonbones-js/out/dragonBones.js";
const source = fs.readFileSync(file, "utf8").replace(/^export .*$/gm, "").replace(/export\s*\{[^}]*\};?/g, "");
const db = new Function(`${source}; return dragonBones;`)();
db.DragonBones.yDown = true; // this fork turns y over unless told
const folder = process.argv[2];
const read = (name) => JSON.parse(fs.readFileSync(path.join(folder, name)));
const expected = read("expected.json");
class Proxy {
  dbInit() {}
  dbClear() {}
  dbUpdate() {}
  dispose() {}
  hasDBEventListener() { return false; }
  dispatchDBEvent() {}
  addDBEventListener() {}
  removeDBEventListener() {}
}
class Slot extends db.Slot { static toString() { return "Slot"; } }
for (const name of "_initDisplay _disposeDisplay _onUpdateDisplay _addDisplay _replaceDisplay _removeDisplay _updateZOrder _updateVisible _updateBlendMode _updateColor _updateFrame _updateMesh _updateTransform _identityTransform _updateGlueMesh".split(" ")) Slot.prototype[name] = () => {};
class Texture extends db.TextureData { static toString() { return "Texture"; } }
class Atlas extends db.TextureAtlasData {
  static toString() { return "Atlas"; }
  createTexture() { return db.BaseObject.borrowObject(Texture); }
}
const world = new db.DragonBones(new Proxy());
class Factory extends db.BaseFactory {
  constructor() { super(null); this._dragonBones = world; }
  _buildTextureAtlasData(data) { return data || db.BaseObject.borrowObject(Atlas); }
  _buildArmature(pack) {
    const armature = db.BaseObject.borrowObject(db.Armature), proxy = new Proxy();
    armature.init(pack.armature, proxy, proxy, world);
    return armature;
  }
  _buildSlot(pack, data, armature) {
    const slot = db.BaseObject.borrowObject(Slot);
    slot.init(data, armature, {}, {});
    return slot;
  }
}
const factory = new Factory();
factory.parseDragonBonesData(read("puppet_ske.json"));
factory.parseTextureAtlasData(read("puppet_tex.json"), {});
const armature = factory.buildArmature(expected.name);
for (const slot of armature.getSlots()) slot.displayIndex = 0; // hidden ones too
armature.advanceTime(0);
let worst = 0;
const judge = (meshes) => armature.getSlots().forEach((slot, k) => {
  const deform = slot._deformVertices ?? slot._geometryData ?? slot, data = deform.verticesData ?? deform;
  const weight = data.weight, ints = data.data.intArray, floats = data.data.floatArray, bones = deform.bones;
  let b = weight.offset + 2 + weight.bones.length, v = ints[weight.offset + 1];
  for (let i = 0; i < ints[data.offset]; i++) {
    let x = 0, y = 0;
    for (let j = ints[b++]; j > 0; j--) {
      const m = bones[ints[b++]].globalTransformMatrix, w = floats[v++], px = floats[v++], py = floats[v++];
      x += w * (m.a * px + m.c * py + m.tx);
      y += w * (m.b * px + m.d * py + m.ty);
    }
    worst = Math.max(worst, Math.hypot(x - meshes[k][i][0], -y - meshes[k][i][1]));
  }
});
for (const { turned, meshes } of expected.poses) {
  for (const bone of armature.getBones()) {
    bone.offset.rotation = (-(turned[bone.name] ?? 0) * Math.PI) / 180;
    bone.invalidUpdate();
  }
  armature.advanceTime(0);
  judge(meshes);
}
for (const bone of armature.getBones()) { bone.offset.rotation = 0; bone.invalidUpdate(); }
for (const { name, time, meshes } of expected.moments) {
  armature.animation.gotoAndStopByTime(name, time);
  armature.advanceTime(0);
  judge(meshes);
}
console.log(JSON.stringify({ worst, slots: armature.getSlots().length, bones: armature.getBones().length, version: db.DragonBones.VERSION }));
