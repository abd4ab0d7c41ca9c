"""Runs a program for WASI in a folder: run.py COMPILED FOLDER ARGUMENT...; the last argument is a file in the folder.
Before that, once, as it takes seconds: run.py --compile PROGRAM COMPILED."""

import sys

from wasmtime import Engine, ExitTrap, Linker, Module, Store, WasiConfig

engine = Engine()
if sys.argv[1] == "--compile":
    with open(sys.argv[3], "wb") as compiled:
        compiled.write(Module.from_file(engine, sys.argv[2]).serialize())
    sys.exit()
program, folder, *arguments, file = sys.argv[1:]
wasi = WasiConfig()
wasi.argv = ["rtdsl", *arguments, f"/folder/{file}"]
wasi.preopen_dir(folder, "/folder")
wasi.inherit_stdout()
wasi.inherit_stderr()
store = Store(engine)
store.set_wasi(wasi)
linker = Linker(engine)
linker.define_wasi()
instance = linker.instantiate(store, Module.deserialize_file(engine, program))
try:
    instance.exports(store)["_start"](store)
except ExitTrap as end:
    sys.exit(end.code)
