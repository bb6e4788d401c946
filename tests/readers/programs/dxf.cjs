// The package `dxf`: its own polylines; of a text it makes one without points.
const {denormalise, parseString, toPolylines} = require('dxf');
require('./answers.cjs').print((text) => {
  const file = parseString(text);
  const blocks = file.blocks.flatMap((block) => block.entities || []);
  return {
    unit: file.header.insUnits,
    entities: toPolylines(file).polylines.map((line) => ({layer: line.layer.name, points: line.vertices})),
    texts: denormalise(file).filter((one) => one.type === 'TEXT').map((one) => one.string),
  };
});
