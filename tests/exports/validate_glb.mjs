// Has the Khronos glTF validator look at .glb files: validate_glb.mjs FILE...
// Run in the folder whose node_modules holds gltf-validator.
import { createRequire } from 'node:module';
import { readFileSync } from 'node:fs';
import path from 'node:path';

const require = createRequire(path.join(process.cwd(), 'package.json'));
const validator = require('gltf-validator');

const options = { maxIssues: 0, writeTimestamp: false };
const look = (bytes) => validator.validateBytes(new Uint8Array(bytes), options);

let failed = false;
for (const file of process.argv.slice(2)) {
  const bytes = readFileSync(file);
  const report = await look(bytes);
  const { numErrors, numWarnings } = report.issues;
  const info = report.info;
  console.log(
    `${path.basename(file)}: ${numErrors} errors, ${numWarnings} warnings; ` +
      `${info.drawCallCount} meshes drawn, ${info.animationCount} animations`,
  );
  if (numErrors + numWarnings > 0) {
    failed = true;
    for (const issue of report.issues.messages.slice(0, 20)) {
      console.error(`  ${issue.code} at ${issue.pointer}: ${issue.message}`);
    }
  }
  // The check can fail: the same file with a length that is none.
  const damaged = Buffer.from(bytes);
  damaged.writeUInt32LE(bytes.length + 4, 8);
  if ((await look(damaged)).issues.numErrors === 0) {
    console.error('the validator finds nothing wrong with a damaged file');
    failed = true;
  }
}
process.exit(failed ? 1 : 0);
