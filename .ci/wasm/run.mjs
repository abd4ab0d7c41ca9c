// Runs a program for WASI in a folder: node run.mjs PROGRAM FOLDER ARGUMENT...; the last argument is a file in the folder.
import { readFile } from 'node:fs/promises';
import { WASI } from 'node:wasi';

const [program, folder, ...args] = process.argv.slice(2);
args.push(`/folder/${args.pop()}`);
const wasi = new WASI({ version: 'preview1', args: ['rtdsl', ...args], preopens: { '/folder': folder } });
const { instance } = await WebAssembly.instantiate(await readFile(program), wasi.getImportObject());
process.exitCode = wasi.start(instance);
