#!/usr/bin/env python3
"""`gsk980td lsp` driven by a client nobody here wrote.

`pytest-lsp` (PyPI; its client is that of `pygls`, its types those of `lsprotocol`, made
from the specification) starts the program, asks every request with the capabilities of
several editors, and checks the messages against what those editors said they can do. Then
come malformed messages, requests before `initialize` and after `shutdown`, methods that are
not there, and a program of 100 000 blocks that is typed in.

    pip install pytest-lsp
    cargo build --release
    tests/oracles/language_client.py [target/release/gsk980td]
"""

import asyncio
import json
import statistics
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcException
from pytest_lsp import LspSpecificationWarning, client_capabilities
from pytest_lsp.client import make_test_lsp_client

ROOT = Path(__file__).resolve().parent.parent.parent
EDITORS = ["visual-studio-code", "neovim", "emacs"]
BLOCKS = 100_000
KEYSTROKES = 20
PUBLISH = "textDocument/publishDiagnostics"

MAIN = """O0001 (轴)
N10 T0101 M03 S800
N20 G00 X62 Z2
N30 G71 U2 R1
N40 G71 P50 Q70 U0.5 W0.1 F150
N50 G00 X20
N60 G01 Z-30
N70 X60
N80 M98 P31
N90 T0202
N100 G00 X100 Z100
N110 M30
"""
SUB = "O0031\nG01 U-1 F100\nM99\n"
checked = 0


def check(what, found, wanted):
    global checked
    checked += 1
    if found != wanted:
        raise SystemExit(f"{what}:\n  {found!r}\nwanted\n  {wanted!r}")


async def refused(what, asked, code):
    try:
        answer = await asked
    except JsonRpcException as error:
        check(what, error.code, code)
    else:
        raise SystemExit(f"{what}: answered with {answer!r}")


class Session:
    """A server and a folder of programs."""

    def __init__(self, program, folder):
        self.program, self.folder = program, Path(folder)
        self.client = make_test_lsp_client()

    async def start(self, editor, *options):
        await self.client.start_io(self.program, "lsp", *options)
        capabilities = client_capabilities(editor)
        params = lsp.InitializeParams(capabilities=capabilities, process_id=None, locale="en")
        return await self.client.initialize_session(params)

    def uri(self, name):
        return (self.folder / name).as_uri()

    async def diagnostics(self, name):
        """What is published of a document next."""
        uri = self.uri(name)
        while True:
            params = await self.client.wait_for_notification(PUBLISH)
            if params.uri == uri:
                return params

    async def open(self, name, text):
        item = lsp.TextDocumentItem(self.uri(name), "gsk980td", 1, text)
        published = asyncio.ensure_future(self.diagnostics(name))
        await asyncio.sleep(0)
        self.client.text_document_did_open(lsp.DidOpenTextDocumentParams(item))
        return await asyncio.wait_for(published, 60)

    async def change(self, name, version, line, columns, text):
        place = lsp.Range(lsp.Position(line, columns[0]), lsp.Position(line, columns[1]))
        change = lsp.TextDocumentContentChangePartial(range=place, text=text)
        document = lsp.VersionedTextDocumentIdentifier(version, self.uri(name))
        published = asyncio.ensure_future(self.diagnostics(name))
        await asyncio.sleep(0)
        params = lsp.DidChangeTextDocumentParams(document, [change])
        self.client.text_document_did_change(params)
        return await asyncio.wait_for(published, 60)

    def document(self, name):
        return lsp.TextDocumentIdentifier(self.uri(name))

    async def end(self):
        await self.client.shutdown_session()


def lines(locations):
    return sorted(location.range.start.line for location in locations)


async def all_requests(program, editor):
    with tempfile.TemporaryDirectory() as folder:
        session = Session(program, folder)
        (Path(folder) / "O0031.CNC").write_text(SUB)
        result = await session.start(editor, "--lang", "en")
        check("name", result.server_info.name, "gsk980td")
        client, document = session.client, session.document("main.CNC")
        published = await session.open("main.CNC", MAIN)
        check("a right program", list(published.diagnostics), [])

        # A wrong word behind characters of three bytes; then it is taken back.
        published = await session.change("main.CNC", 2, 6, (4, 4), "(圆弧) Y1 ")
        found = published.diagnostics[0]
        bytes_of = str(result.capabilities.position_encoding) == "utf-8"
        column = 13 if bytes_of else 9
        check("code", (found.code, found.severity), ("009", lsp.DiagnosticSeverity.Error))
        check("line", (published.version, found.range.start.line), (2, 6))
        check("column", (found.range.start.character, found.range.end.character), (column, column + 2))
        published = await session.change("main.CNC", 3, 6, (4, column + 3), "")
        check("taken back", list(published.diagnostics), [])

        def at(line, column):
            return document, lsp.Position(line, column)

        hover = await client.text_document_hover_async(lsp.HoverParams(*at(3, 5)))
        check("hover", "G71: roughing along Z" in hover.contents.value, True)
        check("its range", (hover.range.start.character, hover.range.end.character), (4, 7))
        hover = await client.text_document_hover_async(lsp.HoverParams(*at(8, 9)))
        check("hover of a call", "G01 U-1 F100" in hover.contents.value, True)
        items = await client.text_document_completion_async(lsp.CompletionParams(*at(3, 5)))
        labels = [item.label for item in items]
        check("completion", {"G00", "G71", "G99"} <= set(labels), True)
        snippets = client.capabilities.text_document.completion.completion_item.snippet_support
        check("snippets", "G71 …" in labels, bool(snippets))
        led = await client.text_document_definition_async(lsp.DefinitionParams(*at(4, 9)))
        check("definition", lines(led), [5])
        led = await client.text_document_definition_async(lsp.DefinitionParams(*at(8, 9)))
        check("definition in a file", [it.uri for it in led], [session.uri("O0031.CNC")])
        context = lsp.ReferenceContext(include_declaration=True)
        found = await client.text_document_references_async(lsp.ReferenceParams(context, *at(5, 2)))
        check("references", lines(found), [4, 5])
        found = await client.text_document_document_highlight_async(lsp.DocumentHighlightParams(*at(5, 2)))
        check("highlight", lines(found), [4, 5])
        symbols = await client.text_document_document_symbol_async(lsp.DocumentSymbolParams(document))
        check("symbols", [symbol.name for symbol in symbols], ["O0001 轴"])
        within = [symbol.name for symbol in symbols[0].children]
        check("within", within, ["T0101", "N50", "N70", "T0202"])
        folds = await client.text_document_folding_range_async(lsp.FoldingRangeParams(document))
        folds = [(fold.start_line, fold.end_line) for fold in folds]
        check("folds", folds, [(0, 11), (1, 8), (5, 7), (9, 11)])
        lenses = await client.text_document_code_lens_async(lsp.CodeLensParams(document))
        titles = [lens.command.title for lens in lenses]
        check("lens", ("T0101 T0202" in titles[0], "with this tool" in titles[1]), (True, True))
        place = await client.text_document_prepare_rename_async(lsp.PrepareRenameParams(*at(4, 9)))
        check("what is renamed", (place.start.line, place.start.character), (4, 9))
        edit = await client.text_document_rename_async(lsp.RenameParams(document, lsp.Position(4, 9), "N55"))
        edits = edit.changes[session.uri("main.CNC")]
        check("rename", sorted((it.range.start.line, it.new_text) for it in edits), [(4, "55"), (5, "55")])
        await refused("a number that is there", client.text_document_rename_async(lsp.RenameParams(document, lsp.Position(4, 9), "60")), -32803)
        help = await client.text_document_signature_help_async(lsp.SignatureHelpParams(*at(4, 12)))
        check("signature", (help.signatures[help.active_signature].label, help.active_parameter), ("G71 P Q U W F S T", 1))
        tokens = await client.text_document_semantic_tokens_full_async(lsp.SemanticTokensParams(document))
        legend = result.capabilities.semantic_tokens_provider.legend
        kinds = {legend.token_types[kind] for kind in tokens.data[3::5]}
        check("kinds of words", {"type", "keyword", "function", "parameter", "property", "comment"} <= kinds, True)
        lines_of = lsp.Range(lsp.Position(7, 0), lsp.Position(7, 7))
        params = lsp.InlayHintParams(document, lines_of)
        check("no hints", list(await client.text_document_inlay_hint_async(params)), [])
        settings = {"gsk980td": {"hints": {"modal": True}}}
        client.workspace_did_change_configuration(lsp.DidChangeConfigurationParams(settings))
        hints = await client.text_document_inlay_hint_async(params)
        check("modal codes", [hint.label for hint in hints], ["G01"])
        found = await client.workspace_symbol_async(lsp.WorkspaceSymbolParams("o"))
        check("programs of the folder", [it.name for it in found], ["O0001 轴", "O0031"])
        published = await session.change("main.CNC", 4, 8, (11, 11), " L3")
        check("a word without effect", [it.code for it in published.diagnostics], ["ignored-word"])
        context = lsp.CodeActionContext(diagnostics=list(published.diagnostics))
        if result.capabilities.code_action_provider:
            place = published.diagnostics[0].range
            actions = await client.text_document_code_action_async(lsp.CodeActionParams(document, place, context))
            check("quick fix", [it.title for it in actions], ["Write P30031"])
        await session.change("main.CNC", 5, 8, (11, 14), "")
        options = lsp.FormattingOptions(tab_size=4, insert_spaces=True)
        settings = {"gsk980td": {"format": {"numbers": "all", "start": 1, "step": 1}}}
        client.workspace_did_change_configuration(lsp.DidChangeConfigurationParams(settings))
        edits = await client.text_document_formatting_async(lsp.DocumentFormattingParams(document, options))
        texts = [edit.new_text for edit in edits]
        check("format", "N4 G71 P5 Q7 U0.5 W0.1 F150" in texts, True)
        part = lsp.Range(lsp.Position(1, 0), lsp.Position(2, 0))
        edits = await client.text_document_range_formatting_async(lsp.DocumentRangeFormattingParams(document, part, options))
        check("format of lines", list(edits), [])
        client.text_document_did_save(lsp.DidSaveTextDocumentParams(document))
        client.text_document_did_close(lsp.DidCloseTextDocumentParams(document))
        await refused("a closed document", client.text_document_hover_async(lsp.HoverParams(*at(3, 5))), -32602)
        await refused("no method", client.protocol.send_request_async("textDocument/nothing", {}), -32601)
        await session.end()


def message(content):
    body = content if isinstance(content, bytes) else json.dumps(content).encode()
    return b"Content-Length: %d\r\n\r\n%s" % (len(body), body)


def raw(program):
    """Messages that no client sends."""

    def run(*messages):
        done = subprocess.run([program, "lsp"], input=b"".join(messages), capture_output=True, timeout=60)
        answers = []
        rest = done.stdout
        while rest:
            head, _, rest = rest.partition(b"\r\n\r\n")
            length = int(head.split(b":")[1])
            answers.append(json.loads(rest[:length]))
            rest = rest[length:]
        return done, answers

    def request(number, method, params=None):
        return message({"jsonrpc": "2.0", "id": number, "method": method, "params": params})

    begin = request(1, "initialize", {"capabilities": {}, "processId": None, "rootUri": None})
    exit_ = message({"jsonrpc": "2.0", "method": "exit"})
    done, answers = run(request(1, "textDocument/hover", {}), begin, request(2, "textDocument/hover", {"position": 7}), request(3, "shutdown"), request(4, "textDocument/hover", {}), exit_)
    codes = [answer.get("error", {}).get("code") for answer in answers]
    check("before initialize, wrong parameters, after shutdown", (codes, done.returncode), ([-32002, None, -32602, None, -32600], 0))
    done, _ = run(begin, exit_)
    check("exit without shutdown", done.returncode, 1)
    done, _ = run(begin)
    check("an editor that is gone", done.returncode, 1)
    for wrong in [message(b"{]{]"), b"Content-Length: x\r\n\r\n{}", b"no header at all\r\n\r\n", message(b"[1]"), message(b"\xff\xfe")]:
        done, _ = run(begin, wrong)
        check(f"{wrong!r}", (done.returncode, b"panicked" in done.stderr), (2, False))
    done, answers = run(request(1, "initialize", 7), begin, request(2, "shutdown"), exit_)
    check("initialize with nonsense", (answers[0]["error"]["code"], done.returncode), (-32602, 0))


def long_program():
    blocks = ["O0001 (long)", "M03 S800 T0101", "G98 F300", "G00 X100 Z2"]
    for block in range(BLOCKS):
        x, z = 20 + block % 50, block % 90
        blocks.append(f"N{block % 9999:04} G01 X{x}.{block % 997:03} Z-{z}.5")
    return "\n".join(blocks + ["G00 X100 Z100", "M30", ""])


async def long_one(program):
    with tempfile.TemporaryDirectory() as folder:
        session = Session(program, folder)
        await session.start("visual-studio-code", "--lang", "en")
        published = await session.open("long.CNC", long_program())
        check("a long program", list(published.diagnostics), [])
        spent = []
        for stroke in range(KEYSTROKES):
            wrong = stroke % 2 == 0
            columns, text = ((5, 5), "?") if wrong else ((5, 6), "")
            begun = time.perf_counter()
            published = await session.change("long.CNC", 2 + stroke, BLOCKS // 2, columns, text)
            spent.append(1000 * (time.perf_counter() - begun))
            check("its alarm", len(published.diagnostics) > 0, wrong)
        await session.end()
        spent.sort()
        print(f"{BLOCKS} blocks, from a keystroke to its diagnostics: median {statistics.median(spent):.0f} ms, worst {spent[-1]:.0f} ms")


def main():
    program = str(Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "target/release/gsk980td").resolve())
    # What an editor did not say it can do must not be sent to it.
    warnings.simplefilter("error", LspSpecificationWarning)
    for editor in EDITORS:
        asyncio.run(all_requests(program, editor))
        print(f"{editor}: every request")
    raw(program)
    asyncio.run(long_one(program))
    print(f"{checked} answers as wanted")


if __name__ == "__main__":
    main()
