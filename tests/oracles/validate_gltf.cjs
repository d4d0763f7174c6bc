// The Khronos glTF-Validator on files: one line of JSON a file, {"file", "errors", "warnings", "messages"}.
//
//     NODE_PATH=.node/node_modules node tests/oracles/validate_gltf.cjs FILE...
const fs = require("fs");
const validator = require("gltf-validator");

async function main(files) {
  for (const file of files) {
    const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), { maxIssues: 100 });
    const { numErrors, numWarnings, messages } = report.issues;
    const said = messages.filter((message) => message.severity <= 1);
    console.log(JSON.stringify({ file, errors: numErrors, warnings: numWarnings, messages: said }));
  }
}

main(process.argv.slice(2)).catch((error) => {
  console.error(String(error));
  process.exit(1);
});
