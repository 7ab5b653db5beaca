// Judges a manifest of a Kubernetes Job by the API's own schema (npm kubernetes-models). usage: kubernetes_job.mjs FILE.yaml
// Exit code 1: it is none, with the reason.
import fs from "node:fs";
import { Job } from "kubernetes-models/batch/v1";
import { parse } from "yaml";

try {
  new Job(parse(fs.readFileSync(process.argv[2], "utf8"))).validate();
} catch (error) {
  console.error(error.message);
  process.exit(1);
}
