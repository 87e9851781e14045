(* SPDX-License-Identifier: BSD-3-Clause *)
(* fcl_artic_prove: the extracted checker (doc/PROVEN_CHECKER.md) on a world and its certificates. *)
open Checker

let contents path =
  let c = open_in_bin path in
  let text = really_input_string c (in_channel_length c) in
  close_in c;
  text

let pairs w m =
  let bodies = Array.of_list w.bodies in
  let count = ref 0 in
  Array.iteri (fun j b -> for i = 0 to j - 1 do if checked w m bodies.(i) b then incr count done) bodies;
  !count

(* Which part of the claim is not shown. *)
let fault w m =
  if not (is_meaningful w m) then "no rotation is near the nine numbers of some pose"
  else if not (reasons_ok w) then "some pair that is unchecked has not the reason that the world gives"
  else if not (pieces_join w m.pieces) then "the motion jumps between two pieces"
  else "some pair is not shown to be apart"

let usage = "usage: fcl_artic_prove [--quiet] [--times] WORLD CERTIFICATES..."

(* Exit: 0 all are proven, 1 some are not, 2 an input is bad or out of scope. *)
let () =
  let options, files = List.partition (fun a -> String.length a > 1 && a.[0] = '-') (List.tl (Array.to_list Sys.argv)) in
  if List.exists (fun o -> o <> "--quiet" && o <> "--times") options || List.length files < 2 then begin
    prerr_endline usage;
    exit 2
  end;
  let quiet = List.mem "--quiet" options and times = List.mem "--times" options in
  let worst = ref 0 and proven = ref 0 and all = ref 0 in
  let note code text =
    worst := max !worst code;
    print_endline text
  in
  (try
     let text = contents (List.hd files) in
     let hash = Sha256.hex (Sha256.of_string text) in
     let w, variables = Read.world text in
     List.iter
       (fun file ->
         List.iteri
           (fun k (motion, proof) ->
             incr all;
             let where = Printf.sprintf "%s, record %d: " file k in
             let begun = Sys.time () in
             (try
                let m, of_world = Read.motion motion variables (List.length w.bodies) in
                let of_motion, roots, contact = Read.proof proof in
                if of_world <> hash then note 1 (where ^ "not proven: the motion is about another world")
                else if of_motion <> Sha256.of_string motion then
                  note 1 (where ^ "not proven: the proof is about another motion")
                else begin
                  let n = pairs w m in
                  if n = 0 then note 1 (where ^ "not proven: the claim is about no pair of bodies")
                  else if accepts w m roots then begin
                    incr proven;
                    if not quiet then 
                      Printf.printf "%sproven, %d pairs%s\n" where n
                        (if contact then "; that bodies meet later is not looked at" else "")
                  end
                  else note 1 (where ^ "not proven: " ^ fault w m)
                end
              with
             | Read.Bad_input why -> note 2 (where ^ "bad input: " ^ why)
             | Read.Out_of_scope what -> note 2 (where ^ "out of scope: " ^ what));
             if times then Printf.printf "%s%.6f s\n" where (Sys.time () -. begun))
           (Read.records (contents file)))
       (List.tl files)
   with
  | Read.Bad_input why -> note 2 ("bad input: " ^ why)
  | Read.Out_of_scope what -> note 2 ("out of scope: " ^ what)
  | Sys_error why -> note 2 why);
  Printf.printf "%d of %d records proven\n" !proven !all;
  exit !worst
